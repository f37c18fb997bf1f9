// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/scene/support_plane.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "pcavr/geometry/pixel.hpp"

#include "convex_outline.hpp"
#include "plane_ransac.hpp"

namespace pcavr {
namespace {

/// Slope limit of a support plane: most objects slide above 15 degrees (friction 0.27).
const double kMinUpward = std::cos(15.0 * M_PI / 180.0);
/// Slope limit of vertex normals, wider due to mesh noise.
const float kMinNormalUpward = std::cos(30.0F * static_cast<float>(M_PI) / 180.0F);
/// Max vertical distance of a body's lowest point from the plane, for errors of pose and surface
/// [m].
constexpr double kMaxGap = 0.03;
/// Search margin around the body, as the surface beneath it was not observed [m].
constexpr double kSearchMargin = 0.15;
/// Initial inlier distance; also the maximum [m].
constexpr double kInlierDistance = 0.01;
/// The inlier distance is then 3 standard deviations, at least this [m].
constexpr double kMinInlierDistance = 0.003;
/// Cell edge for clustering: points in the same or in adjacent cells are connected [m].
constexpr double kCellEdge = 0.03;
constexpr std::size_t kMinPoints = 30;

using Points = std::vector<Eigen::Vector3d>;

/// Vertices with an upward normal.
Points upward_points(const TriangleMesh& mesh) {
  const TriangleMesh* with_normals = &mesh;
  TriangleMesh copy;
  if (mesh.normals.empty()) {
    copy = mesh;
    compute_vertex_normals(copy);
    with_normals = &copy;
  }
  Points points;
  for (std::size_t i = 0; i < with_normals->vertices.size(); ++i) {
    if (with_normals->normals[i].z() < kMinNormalUpward) continue;
    points.push_back(with_normals->vertices[i].cast<double>());
  }
  return points;
}

struct Footprint {
  Eigen::AlignedBox2d box;  ///< from above
  double lowest = 0.0;      ///< z of the body's lowest point [m]

  [[nodiscard]] Eigen::Vector3d middle() const {
    return {box.center().x(), box.center().y(), lowest};
  }
};

Footprint footprint_of(const SupportedBody& body) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : body.mesh_object->vertices) {
    box.extend(body.T_base_object * vertex.cast<double>().eval());
  }
  return {{box.min().head<2>(), box.max().head<2>()}, box.min().z()};
}

/// Total least squares plane fit (PCA) [Pearson 1901], normal upward; and the rms distance.
std::pair<Plane, double> fit(const Points& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) {
    scatter += (point - mean) * (point - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  Plane plane;
  plane.normal = solver.eigenvectors().col(0);
  if (plane.normal.z() < 0.0) plane.normal = -plane.normal;
  plane.offset = plane.normal.dot(mean);
  const double variance =
      std::max(0.0, solver.eigenvalues()[0]) / static_cast<double>(points.size());
  return {plane, std::sqrt(variance)};
}

using Cell = std::pair<int, int>;

Cell cell_of(const Eigen::Vector3d& point) {
  constexpr int kFarAway = 1'000'000'000;  // [cells]; a mesh file may contain any number
  return {clamp_to_int(std::floor(point.x() / kCellEdge), -kFarAway, kFarAway),
          clamp_to_int(std::floor(point.y() / kCellEdge), -kFarAway, kFarAway)};
}

/// Inliers of the plane, clustered in the x-y plane (connected components): the largest cluster
/// with a point close to `near` (empty: the largest of all).
Points connected_inliers(const Points& points, const Plane& plane, double distance,
                         const std::optional<Footprint>& near) {
  std::map<Cell, Points> cells;
  for (const Eigen::Vector3d& point : points) {
    if (std::abs(plane.signed_distance(point)) <= distance) cells[cell_of(point)].push_back(point);
  }
  Points largest;
  while (!cells.empty()) {
    Points cluster;
    bool is_near = !near;
    std::vector<Cell> open = {cells.begin()->first};
    while (!open.empty()) {
      const Cell cell = open.back();
      open.pop_back();
      const auto found = cells.find(cell);
      if (found == cells.end()) continue;
      for (const Eigen::Vector3d& point : found->second) {
        is_near = is_near || near->box.exteriorDistance(point.head<2>().eval()) <= kSearchMargin;
      }
      cluster.insert(cluster.end(), found->second.begin(), found->second.end());
      cells.erase(found);
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) open.emplace_back(cell.first + dx, cell.second + dy);
      }
    }
    if (is_near && cluster.size() > largest.size()) largest = std::move(cluster);
  }
  return largest;
}

/// Region growing: from the RANSAC plane near a body to all connected inliers, in three rounds.
std::optional<SupportPlane> grow_region(Plane plane, const Points& points,
                                        const std::optional<Footprint>& near) {
  double distance = kInlierDistance;
  SupportPlane support;
  Points inliers;
  for (int round = 0; round < 3; ++round) {
    inliers = connected_inliers(points, plane, distance, near);
    if (inliers.size() < kMinPoints) return std::nullopt;
    std::tie(plane, support.rms) = fit(inliers);
    distance = std::clamp(3.0 * support.rms, kMinInlierDistance, kInlierDistance);
  }
  if (plane.normal.z() < kMinUpward) return std::nullopt;
  support.plane_base = plane;
  support.outline_base = convex_outline(inliers, plane);
  return support;
}

std::optional<SupportPlane> plane_below(const Points& points, const Footprint& footprint) {
  Points candidates;
  for (const Eigen::Vector3d& point : points) {
    if (std::abs(point.z() - footprint.lowest) > kMaxGap) continue;
    if (footprint.box.exteriorDistance(point.head<2>().eval()) > kSearchMargin) continue;
    candidates.push_back(point);
  }
  const std::optional<Plane> seed = ransac_plane(candidates, kInlierDistance, kMinUpward);
  if (!seed) return std::nullopt;
  return grow_region(*seed, points, footprint);
}

bool stands_on(const SupportPlane& plane, const Footprint& footprint) {
  return std::abs(plane.plane_base.signed_distance(footprint.middle())) <= kInlierDistance &&
         is_above_outline(plane.outline_base, footprint.middle());
}

}  // namespace

std::vector<SupportPlane> find_support_planes(const TriangleMesh& mesh_base,
                                              const std::vector<SupportedBody>& bodies) {
  const Points points = upward_points(mesh_base);
  std::vector<SupportPlane> planes;
  for (const SupportedBody& body : bodies) {
    PCAVR_REQUIRE(body.mesh_object != nullptr && !body.mesh_object->vertices.empty(), body.name);
    const Footprint footprint = footprint_of(body);
    auto found = std::find_if(planes.begin(), planes.end(), [&](const SupportPlane& plane) {
      return stands_on(plane, footprint);
    });
    if (found == planes.end()) {
      std::optional<SupportPlane> plane = plane_below(points, footprint);
      if (!plane) continue;
      found = planes.insert(planes.end(), std::move(*plane));
    }
    found->objects.push_back(body.name);
  }
  if (!bodies.empty()) return planes;
  if (const auto seed = ransac_plane(points, kInlierDistance, kMinUpward)) {
    if (auto plane = grow_region(*seed, points, std::nullopt)) planes.push_back(std::move(*plane));
  }
  return planes;
}

}  // namespace pcavr
