// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/support_plane.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/pixel.hpp"

#include "convex_outline.hpp"
#include "plane_ransac.hpp"

namespace pcavr {
namespace {

/// Slope limit of vertex normals, wider due to mesh noise.
const float kMinNormalUpward = std::cos(30.0F * static_cast<float>(M_PI) / 180.0F);
using Points = std::vector<Eigen::Vector3d>;
/// Of more vertices, as those of a hall, every second, third, ... grows a plane: so many at 5 mm
/// are 25 m^2.
constexpr std::size_t kMaxVertices = 1'000'000;

/// Every `stride`-th vertex with an upward normal, of those for which `is_used`.
template <typename IsUsed>
Points upward_points(const TriangleMesh& mesh, std::size_t stride, const IsUsed& is_used) {
  Points points;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += stride) {
    if (mesh.normals[i].z() < kMinNormalUpward) continue;
    const Eigen::Vector3d point = mesh.vertices[i].cast<double>();
    if (is_used(point)) points.push_back(point);
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

Cell cell_of(const Eigen::Vector3d& point, double edge) {
  constexpr int kFarAway = 1'000'000'000;  // [cells]; a mesh file may contain any number
  return {clamp_to_int(std::floor(point.x() / edge), -kFarAway, kFarAway),
          clamp_to_int(std::floor(point.y() / edge), -kFarAway, kFarAway)};
}

/// Inliers of the plane, clustered in the x-y plane (connected components): the largest cluster
/// with a point close to `near` (empty: the largest of all).
Points connected_inliers(const Points& points, const Plane& plane, double distance,
                         const std::optional<Footprint>& near, const SupportPlaneOptions& options) {
  std::map<Cell, Points> cells;
  for (const Eigen::Vector3d& point : points) {
    if (std::abs(plane.signed_distance(point)) > distance) continue;
    cells[cell_of(point, options.cluster_gap)].push_back(point);
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
        is_near =
            is_near || near->box.exteriorDistance(point.head<2>().eval()) <= options.search_margin;
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
                                        const std::optional<Footprint>& near,
                                        const SupportPlaneOptions& options) {
  double distance = options.max_inlier_distance;
  SupportPlane support;
  Points inliers;
  for (int round = 0; round < 3; ++round) {
    inliers = connected_inliers(points, plane, distance, near, options);
    if (inliers.size() < static_cast<std::size_t>(options.min_points)) return std::nullopt;
    std::tie(plane, support.rms) = fit(inliers);
    distance =
        std::clamp(3.0 * support.rms, options.min_inlier_distance, options.max_inlier_distance);
  }
  if (plane.normal.z() < std::cos(options.max_slope)) return std::nullopt;
  support.plane_base = plane;
  support.outline_base = convex_outline(inliers, plane);
  return support;
}

/// Searched among all vertices near the body, and grown over `points`.
std::optional<SupportPlane> plane_below(const TriangleMesh& mesh, const Points& points,
                                        const Footprint& footprint,
                                        const SupportPlaneOptions& options) {
  const auto is_near = [&](const Eigen::Vector3d& point) {
    return std::abs(point.z() - footprint.lowest) <= options.max_gap &&
           footprint.box.exteriorDistance(point.head<2>().eval()) <= options.search_margin;
  };
  const Points candidates = upward_points(mesh, 1, is_near);
  const std::optional<Plane> seed =
      ransac_plane(candidates, options.max_inlier_distance, std::cos(options.max_slope));
  if (!seed) return std::nullopt;
  return grow_region(*seed, points, footprint, options);
}

bool stands_on(const SupportPlane& plane, const Footprint& footprint,
               const SupportPlaneOptions& options) {
  return std::abs(plane.plane_base.signed_distance(footprint.middle())) <=
             options.max_inlier_distance &&
         is_above_outline(plane.outline_base, footprint.middle());
}

}  // namespace

std::vector<SupportPlane> find_support_planes(const TriangleMesh& mesh_base,
                                              const std::vector<SupportedBody>& bodies,
                                              const SupportPlaneOptions& options) {
  TriangleMesh with_normals;
  if (mesh_base.normals.empty()) {
    with_normals = mesh_base;
    compute_vertex_normals(with_normals);
  }
  const TriangleMesh& mesh = mesh_base.normals.empty() ? with_normals : mesh_base;
  const Points points = upward_points(mesh, 1 + mesh.vertices.size() / kMaxVertices,
                                      [](const Eigen::Vector3d&) { return true; });
  std::vector<SupportPlane> planes;
  for (const SupportedBody& body : bodies) {
    PCAVR_REQUIRE(body.mesh_object != nullptr && !body.mesh_object->vertices.empty(), body.name);
    const Footprint footprint = footprint_of(body);
    auto found = std::find_if(planes.begin(), planes.end(), [&](const SupportPlane& plane) {
      return stands_on(plane, footprint, options);
    });
    if (found == planes.end()) {
      std::optional<SupportPlane> plane = plane_below(mesh, points, footprint, options);
      if (!plane) continue;
      found = planes.insert(planes.end(), std::move(*plane));
    }
    found->objects.push_back(body.name);
  }
  if (!bodies.empty()) return planes;
  if (const auto seed =
          ransac_plane(points, options.max_inlier_distance, std::cos(options.max_slope))) {
    auto plane = grow_region(*seed, points, std::nullopt, options);
    if (plane) planes.push_back(std::move(*plane));
  }
  return planes;
}

}  // namespace pcavr
