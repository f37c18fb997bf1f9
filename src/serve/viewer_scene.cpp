// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/viewer_scene.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

#include "pcavr/perception/scene/ply_file.hpp"

#include "scene_level.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxShownTriangles = 40'000;  // 5 MB as a list with colours
constexpr std::size_t kMaxShownPoints = 100'000;    // 1.2 MB
constexpr float kFirstCell = 0.005F;                // [m] edge; doubled until there are few enough

/// The first point of each cell, in the cloud's order.
std::vector<Eigen::Vector3f> thinned(const std::vector<Eigen::Vector3f>& points, float edge) {
  std::set<std::array<std::int64_t, 3>> cells;
  std::vector<Eigen::Vector3f> kept;
  for (const Eigen::Vector3f& point : points) {
    std::array<std::int64_t, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = std::llround(point[static_cast<Eigen::Index>(axis)] / edge);
    }
    if (cells.insert(cell).second) kept.push_back(point);
  }
  return kept;
}

Expected<std::vector<Eigen::Vector3f>> shown_points(const std::filesystem::path& cloud_ply) {
  Expected<TriangleMesh> cloud = read_ply(cloud_ply);
  if (!cloud) return cloud.error();
  std::vector<Eigen::Vector3f> points = std::move(cloud->vertices);
  for (float edge = kFirstCell; edge == kFirstCell || points.size() > kMaxShownPoints; edge *= 2) {
    points = thinned(points, edge);
  }
  return points;
}

Expected<TriangleMesh> shown_scan(const SceneManifest& scene, const TriangleMesh& scan) {
  if (scan.triangles.size() <= kMaxShownTriangles || scene.levels_of_detail.size() < 2) return scan;
  for (std::size_t i = 1; i < scene.levels_of_detail.size(); ++i) {
    Expected<TriangleMesh> level = read_scene_level(scene.folder / scene.levels_of_detail[i]);
    const bool is_last = i + 1 == scene.levels_of_detail.size();
    if (!level || is_last || level->triangles.size() <= kMaxShownTriangles) return level;
  }
  return scan;
}

Expected<std::string> read_description(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return Error{.message = "can't be read", .file = file.string()};
  return text;
}

}  // namespace

Expected<ViewerScene> make_viewer_scene(const SceneManifest& scene, const HapticWorldModel& model,
                                        const std::optional<ParameterTable>& parameters) {
  ViewerScene shown;
  Expected<TriangleMesh> scan = shown_scan(scene, model.world.static_mesh_base);
  if (!scan) return scan.error();
  shown.scan_base = std::move(*scan);
  for (const WorldBody& body : model.world.bodies) {
    shown.bodies_object.push_back(body.model.mesh_object);
  }
  if (scene.is_scanned()) {
    Expected<std::vector<Eigen::Vector3f>> points = shown_points(scene.folder / "cloud.ply");
    if (!points) return points.error();
    shown.points_base = std::move(*points);
  }
  if (scene.robot) {
    Expected<std::string> urdf = read_description(scene.folder / scene.robot->urdf);
    if (!urdf) return urdf.error();
    shown.urdf = std::move(*urdf);
    shown.joints = scene.robot->joints;
  }
  if (parameters) shown.parameters = *parameters;
  return shown;
}

}  // namespace pcavr
