// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/glb_file.hpp"
#include "pcavr/perception/scene/octomap_file.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "perception/scene/glb_writer.hpp"
#include "preview.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// scene.yaml stores numbers with ten digits.
constexpr double kSamePosition = 1e-7;  ///< [m]
constexpr double kSameRotation = 1e-6;  ///< [rad]

/// 1234567 as "1 234 567".
std::string with_digit_groups(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t from_end = 3; from_end < text.size(); from_end += 4) {
    text.insert(text.size() - from_end, 1, ' ');
  }
  return text;
}

std::string rounded(double value, int decimals) { return fmt::format("{:.{}f}", value, decimals); }

/// The number of frames that the scene is made of; without depth they gave poses only.
std::string frames_text(const SceneQuality& quality) {
  const std::string recorded = std::to_string(quality.frames_recorded);
  if (quality.frames_recorded == 0) return "no frames";
  if (quality.frames_used == 0) return recorded + " frames without depth";
  return std::to_string(quality.frames_used) + " of " + recorded + " frames used";
}

bool is_same(const Pose& a, const Pose& b) {
  return translation_distance(a, b) <= kSamePosition && rotation_distance(a, b) <= kSameRotation;
}

/// Checks all files of one scene.
class Inspection {
 public:
  explicit Inspection(const SceneManifest& manifest) : manifest_(manifest) {}

  std::vector<SceneCheck> run() {
    check_manifest();
    check_display();
    for (std::size_t i = 1; i < manifest_.levels_of_detail.size(); ++i) check_level(i);
    check_mesh();
    check_cloud();
    check_occupancy();
    check_trajectory();
    check_preview();
    for (const SceneObjectEntry& object : manifest_.objects) check_object(object);
    if (manifest_.robot) check_robot(*manifest_.robot);
    return std::move(checks_);
  }

 private:
  void report(const fs::path& what, std::string summary, const std::string& problem) {
    if (!problem.empty()) summary += (summary.empty() ? "" : ", ") + problem;
    checks_.push_back({what.string(), std::move(summary), problem.empty()});
  }
  /// The file can't be read: the reason, without repeating the file name.
  void report(const fs::path& what, const Error& error) { report(what, "", error.message); }

  void check_manifest() {
    std::string problem;
    std::set<std::string> names;
    for (const SceneObjectEntry& object : manifest_.objects) {
      if (!names.insert(object.name).second) problem = "object " + object.name + " is listed twice";
    }
    for (const NotFoundObject& object : manifest_.not_found) {
      if (!names.insert(object.name).second) problem = "object " + object.name + " is listed twice";
    }
    for (const SupportPlane& plane : manifest_.support_planes) {
      for (const std::string& name : plane.objects) {
        if (!names.contains(name)) problem = "a support plane lists the unknown object " + name;
      }
    }
    for (const MarkerEntry& tag : manifest_.tags) {
      if (tag.role == MarkerRole::object && !names.contains(tag.object)) {
        problem = "tag " + tag.id.to_string() + " is on the unknown object " + tag.object;
      }
    }
    if (manifest_.quality.frames_used > manifest_.quality.frames_recorded) {
      problem = "more frames used than recorded";
    }
    report(kManifestFile,
           std::to_string(manifest_.objects.size()) + " objects, " +
               std::to_string(manifest_.support_planes.size()) + " support planes, " +
               frames_text(manifest_.quality),
           problem);
    for (const NotFoundObject& object : manifest_.not_found) {
      report("objects: " + object.name, "warning: not in the scene: " + object.reason, "");
    }
  }

  void check_display() {
    const Expected<GlbContent> glb = read_glb(manifest_.folder / kDisplayFile);
    if (!glb) return report(kDisplayFile, glb.error());
    std::size_t triangles = 0;
    for (const GlbNode& node : glb->nodes) triangles += node.triangles;
    std::string problem;
    if (glb->root != "base" || !is_same(glb->T_viewer_root, glb_root_pose())) {
      problem = "the root node does not rotate z-up to y-up";
    }
    for (const SceneObjectEntry& object : manifest_.objects) {
      const auto node = std::find_if(glb->nodes.begin(), glb->nodes.end(), [&](const auto& n) {
        return n.name == object.name && is_same(n.T_parent_node, object.T_base_object);
      });
      if (node == glb->nodes.end()) {
        problem = "object " + object.name + " is not at its pose in scene.yaml";
      }
    }
    report(kDisplayFile,
           std::to_string(glb->nodes.size()) + " nodes, " + with_digit_groups(triangles) +
               " triangles",
           problem);
  }

  void check_level(std::size_t level) {
    const fs::path& name = manifest_.levels_of_detail[level];
    const Expected<GlbContent> glb = read_glb(manifest_.folder / name);
    if (!glb) return report(name, glb.error());
    const bool is_sound = glb->nodes.size() == 1 && glb->nodes.front().name == "static_mesh";
    report(name, is_sound ? with_digit_groups(glb->nodes.front().triangles) + " triangles" : "",
           is_sound ? "" : "is not only the static mesh");
  }

  void check_mesh() {
    Expected<TriangleMesh> mesh = read_ply(manifest_.folder / kMeshFile);
    if (!mesh) return report(kMeshFile, mesh.error());
    mesh_ = std::move(*mesh);
    const bool has_all =
        mesh_.vertices.empty() || (!mesh_.normals.empty() && !mesh_.colors.empty());
    report(kMeshFile,
           with_digit_groups(mesh_.triangles.size()) + " triangles, " +
               rounded(surface_area(mesh_), 2) + " m^2",
           has_all ? "" : "without normals or colours");
  }

  void check_cloud() {
    const Expected<TriangleMesh> cloud = read_ply(manifest_.folder / kCloudFile);
    if (!cloud) return report(kCloudFile, cloud.error());
    report(kCloudFile, with_digit_groups(cloud->vertices.size()) + " points",
           cloud->triangles.empty() ? "" : "has faces");
    const Expected<RecordedCloud> pcd = read_cloud(manifest_.folder / kCloudPcdFile);
    if (!pcd) return report(kCloudPcdFile, pcd.error());
    report(kCloudPcdFile, with_digit_groups(pcd->points.size()) + " points",
           pcd->points.size() == cloud->vertices.size() ? "" : "has other points than cloud.ply");
  }

  void check_occupancy() {
    const Expected<OctomapContent> map = read_octomap(manifest_.folder / kOccupancyFile);
    if (!map) return report(kOccupancyFile, map.error());
    report(kOccupancyFile,
           with_digit_groups(map->occupied) + " cells occupied, " + with_digit_groups(map->free) +
               " free, " + rounded(map->resolution, 3) + " m",
           bounds_problem(*map));
  }

  /// Compares the map's bounds to the mesh, as both are made from the same depth. Rays are
  /// truncated by length but depth by z, so that a small part of the mesh may be outside at the far
  /// end.
  [[nodiscard]] std::string bounds_problem(const OctomapContent& map) const {
    constexpr double kMinFraction = 0.95;  // of the vertices: the far end, see above
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(2.0 * map.resolution);
    Eigen::AlignedBox3d box = map.known_base;
    if (!box.isEmpty()) box = Eigen::AlignedBox3d(box.min() - margin, box.max() + margin);
    const auto inside = std::count_if(
        mesh_.vertices.begin(), mesh_.vertices.end(),
        [&](const Eigen::Vector3f& vertex) { return box.contains(vertex.cast<double>()); });
    const double fraction = mesh_.vertices.empty() ? 1.0
                                                   : static_cast<double>(inside) /
                                                         static_cast<double>(mesh_.vertices.size());
    return fraction >= kMinFraction
               ? ""
               : "contains only " + rounded(100.0 * fraction, 0) + " % of the mesh";
  }

  void check_trajectory() {
    const Expected<Trajectory> track = read_camera_trajectory(manifest_);
    if (!track) return report(kTrajectoryFile, track.error());
    report(kTrajectoryFile,
           (track->empty() ? "no frame is part of the scene"
                           : std::to_string(track->size()) + " poses") +
               (manifest_.lines ? "" : ", line count not checked: written by an older version"),
           track->size() == manifest_.quality.frames_used
               ? ""
               : "differs from the number of frames used");
  }

  void check_preview() {
    const Expected<std::string> bytes = read_file(manifest_.folder / kPreviewFile);
    if (!bytes) return report(kPreviewFile, bytes.error());
    ImageDecoder decoder;
    const Expected<ColorImage> image = decoder.color(
        *bytes, {.file = kPreviewFile, .width = kPreviewWidth, .height = kPreviewHeight});
    report(kPreviewFile,
           std::to_string(kPreviewWidth) + " x " + std::to_string(kPreviewHeight) + " pixels",
           image ? "" : image.error().message);
  }

  void check_object(const SceneObjectEntry& object) {
    const Expected<CadModel> model = read_object_model(manifest_, object);
    if (!model) return report(object.mesh, model.error());
    std::string summary = with_digit_groups(model->mesh_object.triangles.size()) + " triangles, ";
    if (const auto& simplification = model->simplification) {
      summary += "simplified from " + with_digit_groups(simplification->full_triangles) +
                 " within " + rounded(1e3 * simplification->max_error, 3) + " mm, ";
    }
    report(object.mesh, summary + rounded(1e3 * model->volume, 3) + " litres, " + object.evidence,
           "");
  }

  void check_robot(const SceneRobotEntry& robot) {
    std::size_t triangles = 0;
    for (const SceneRobotEntry::Link& link : robot.links) {
      const Expected<TriangleMesh> mesh = read_mesh(manifest_.folder / link.mesh);
      if (!mesh) return report(link.mesh, mesh.error());
      triangles += mesh->triangles.size();
    }
    const Expected<std::string> urdf = read_file(manifest_.folder / robot.urdf);
    if (!urdf) return report(robot.urdf, urdf.error());
    report(robot.urdf,
           std::to_string(robot.joints.size()) + " joints, " + std::to_string(robot.links.size()) +
               " links of " + with_digit_groups(triangles) + " triangles",
           "");
  }

  const SceneManifest& manifest_;
  TriangleMesh mesh_;
  std::vector<SceneCheck> checks_;
};

}  // namespace

Expected<std::vector<SceneCheck>> inspect_scene(const fs::path& folder) {
  const Expected<SceneManifest> manifest = read_scene_manifest(folder);
  if (!manifest) return manifest.error();
  return Inspection(*manifest).run();
}

}  // namespace pcavr
