// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

namespace pcavr {
namespace {

// Some ten thousand readings in all determine a median.
constexpr std::size_t kComparedFrames = 8;
constexpr int kPixelStride = 8;  ///< of the pixels that are compared with the mesh

/// Some of a frame's readings, in base.
void collect_points(const RgbdFrame& frame, const CameraModel& color_camera,
                    const Pose& T_base_camera, std::vector<Eigen::Vector3f>& points_base) {
  const CameraModel camera = on_grid(color_camera, frame.depth.width(), frame.depth.height());
  for (int y = 0; y < camera.height; y += kPixelStride) {
    for (int x = 0; x < camera.width; x += kPixelStride) {
      const float z = frame.depth(x, y);
      if (z <= 0.0F) continue;
      points_base.push_back(
          (T_base_camera * camera.unproject(Eigen::Vector2d(x, y), z)).cast<float>());
    }
  }
}

using Cell = Eigen::Vector3i;

std::uint64_t cell_key(const Cell& cell) {
  const auto bits = [](int c) { return static_cast<std::uint64_t>(c) & 0x1FFFFFU; };
  return bits(cell.x()) << 42 | bits(cell.y()) << 21 | bits(cell.z());
}

/// The cells of some points and those around them, of an edge of `distance`.
class CellsAround {
 public:
  CellsAround(const std::vector<Eigen::Vector3f>& points, double distance)
      : edge_(static_cast<float>(distance)) {
    for (const Eigen::Vector3f& p : points) {
      const Cell cell = cell_of(p);
      for (int i = 0; i < 27; ++i)
        near_.insert(cell_key(cell + Cell(i % 3, i / 3 % 3, i / 9) - Cell::Ones()));
    }
  }

  /// Whether a triangle may be within the distance of one of the points.
  [[nodiscard]] bool meet(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) const {
    Eigen::AlignedBox3f box(mesh.vertices[t[0]]);
    box.extend(mesh.vertices[t[1]]).extend(mesh.vertices[t[2]]);
    const Cell low = cell_of(box.min());
    const Cell high = cell_of(box.max());
    for (int x = low.x(); x <= high.x(); ++x) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int z = low.z(); z <= high.z(); ++z) {
          if (near_.contains(cell_key({x, y, z}))) return true;
        }
      }
    }
    return false;
  }

 private:
  [[nodiscard]] Cell cell_of(const Eigen::Vector3f& p) const {
    return (p / edge_).array().floor().max(-1e6F).min(1e6F).cast<int>();
  }

  float edge_;  ///< [m]
  std::unordered_set<std::uint64_t> near_;
};

/// Of each point the nearest of the triangles that were added.
class NearestOfPoints {
 public:
  NearestOfPoints(std::vector<Eigen::Vector3f> points, double max_distance)
      : points_(std::move(points)),
        max_distance_(static_cast<float>(max_distance)),
        nearest_(points_.size()) {}

  void add(TriangleMesh part) {
    const SurfaceQuery surface(std::move(part));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const auto found = surface.closest(points_[i], max_distance_);
      if (!found) continue;
      const float distance = (points_[i] - found->point).norm();
      if (nearest_[i] && nearest_[i]->distance <= distance) continue;
      nearest_[i] = {distance, std::abs(found->normal.dot(points_[i] - found->point))};
    }
  }

  /// Median distance of the points from their nearest triangles, along these ones' normals [m].
  [[nodiscard]] double median_distance() const {
    std::vector<double> distances;
    for (const auto& nearest : nearest_) {
      if (nearest) distances.push_back(double{nearest->along_normal});
    }
    return median(std::move(distances));
  }

 private:
  struct Nearest {
    float distance;      ///< [m]
    float along_normal;  ///< [m]
  };

  std::vector<Eigen::Vector3f> points_;
  float max_distance_;
  std::vector<std::optional<Nearest>> nearest_;
};

/// Calls `use` with parts of the triangles that may be near the points, in their order: a query of
/// a whole hall would take more memory than all else.
void visit_parts_near(const TriangleMesh& mesh, const CellsAround& cells,
                      const std::function<void(TriangleMesh)>& use) {
  constexpr std::size_t kPartTriangles = 250'000;
  TriangleMesh part;
  std::unordered_map<std::uint32_t, std::uint32_t> number;  // of the part's vertices
  const auto use_part = [&] {
    use(std::exchange(part, {}));
    number.clear();
  };
  for (const auto& triangle : mesh.triangles) {
    if (!cells.meet(mesh, triangle)) continue;
    auto& added = part.triangles.emplace_back(triangle);
    for (std::uint32_t& v : added) {
      const auto [found, is_new] =
          number.try_emplace(v, static_cast<std::uint32_t>(part.vertices.size()));
      if (is_new) part.vertices.push_back(mesh.vertices[v]);
      v = found->second;
    }
    if (part.triangles.size() == kPartTriangles) use_part();
  }
  if (!part.triangles.empty()) use_part();
}

/// Median distance of some frames' readings from the mesh that they were fused into, along its
/// normals [m].
double surface_distance(const Recording& recording, const Survey& survey, const Scene& scene,
                        double max_distance) {
  const std::vector<FramePlacement>& frames = survey.camera.frames;
  const std::size_t stride = std::max<std::size_t>(1, frames.size() / kComparedFrames);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = stride / 2; i < frames.size(); i += stride) {
    if (frames[i].status != PlacementStatus::placed) continue;
    const Expected<RgbdFrame> frame = decode_frame(recording, frames[i].frame);
    if (!frame) continue;
    collect_points(*frame, *recording.manifest.camera, frames[i].T_base_camera, points);
  }
  const CellsAround cells(points, max_distance);
  NearestOfPoints nearest(std::move(points), max_distance);
  visit_parts_near(scene.mesh_base, cells,
                   [&](TriangleMesh part) { nearest.add(std::move(part)); });
  return nearest.median_distance();
}

}  // namespace

InputWarning to_warning(const ConsistencyFinding& finding) {
  return {finding.input(), finding.message + "; " + finding.hint, finding.factor, finding.frames};
}

SceneQuality assess_quality(const Recording& recording, const Survey& survey, const Scene& scene,
                            double max_distance) {
  SceneQuality quality;
  quality.frames_recorded = recording.frames.size() + recording.unpaired_color;
  quality.frames_used = scene.camera_trajectory.size();
  quality.frames_dropped = dropped_frames(recording, survey);
  quality.left_out = recording.left_out;
  for (const MarkerEntry& marker : recording.manifest.markers) {
    const auto seen = survey.tags_seen.find(marker.id);
    quality.tags_seen.emplace_back(marker.id.to_string(),
                                   seen == survey.tags_seen.end() ? 0 : seen->second);
  }
  if (survey.camera.tag_corners_used > 0) {
    quality.tag_reprojection_rms = survey.camera.tag_reprojection_rms;
  }
  quality.tracking_rms = survey.camera.tracking_rms;
  quality.is_fixed_camera = survey.camera.is_fixed_camera;
  std::vector<double> position_stds;
  std::vector<double> rotation_stds;
  for (const FramePlacement& frame : survey.camera.frames) {
    if (frame.status != PlacementStatus::placed) continue;
    position_stds.push_back(frame.position_std);
    rotation_stds.push_back(frame.rotation_std);
  }
  quality.camera_position_std = median(position_stds);
  quality.camera_rotation_std = median(rotation_stds);
  if (quality.frames_used > 0 && !scene.mesh_base.triangles.empty()) {
    quality.surface_rms = surface_distance(recording, survey, scene, max_distance);
  }
  for (const ConsistencyFinding& finding : survey.findings) {
    quality.input_warnings.push_back(to_warning(finding));
  }
  return quality;
}

}  // namespace pcavr
