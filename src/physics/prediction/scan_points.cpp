// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/scan_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pcavr::detail {
namespace {

constexpr double kMinCell = 0.01;            // [m] about the size of a contact
constexpr double kMaxCells = 1000.0;         // along an axis: bounds the memory of a wide scan
constexpr double kMaxSubdivisions = 2000.0;  // of an edge: 16 m
/// Faces with a more vertical normal (its z component) are the support's kind: they are obstacles
/// only from kLevelFactor times `min_obstacle_height` on.
constexpr double kMaxWallNormalZ = 0.7;
constexpr double kLevelFactor = 2.0;
/// Cosine between the normals of scan and body from which a point is of the body's own surface.
constexpr double kMinOwnCosine = 0.3;

/// Decides which points are obstacles of one body.
class Filter {
 public:
  Filter(const ClosestSurface& surface, const PlanarState& start, const WorldOptions& options)
      : surface_(surface),
        position_(start.position),
        turn_(start.yaw),
        max_depth_(options.max_scan_depth),
        low_(surface.bounds().min().z() + options.min_obstacle_height),
        level_low_(surface.bounds().min().z() + kLevelFactor * options.min_obstacle_height),
        high_(surface.bounds().max().z()) {}

  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }

  [[nodiscard]] bool is_obstacle(const Eigen::Vector3d& p_base,
                                 const Eigen::Vector3d& normal_base) const {
    const bool is_level = std::abs(normal_base.z()) > kMaxWallNormalZ;
    if (p_base.z() < (is_level ? level_low_ : low_) || p_base.z() > high_) return false;
    Eigen::Vector3d p = p_base;
    p.head<2>() = turn_.inverse() * (p_base.head<2>() - position_);
    const auto closest = surface_.closest(p, max_depth_);
    if (!closest) return true;
    if (closest->distance < -max_depth_) return false;
    Eigen::Vector3d normal = normal_base;
    normal.head<2>() = turn_.inverse() * normal_base.head<2>();
    return normal.dot(closest->normal) < kMinOwnCosine;
  }

 private:
  const ClosestSurface& surface_;
  Eigen::Vector2d position_;
  Eigen::Rotation2Dd turn_;
  double max_depth_;
  double low_;  // [m] in base, as below
  double level_low_;
  double high_;
};

using Corners = std::array<Eigen::Vector3d, 3>;

/// Samples the inside of a triangle, and its edges from a lower to a higher vertex index: the
/// triangle on an edge's other side has it reversed.
template <typename Visit>
void visit_samples(const Corners& corner, const std::array<std::uint32_t, 3>& index,
                   const Visit& visit) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    longest = std::max(longest, (corner[(i + 1) % 3] - corner[i]).norm());
  }
  const int n =
      static_cast<int>(std::ceil(std::min(longest / ScanPoints::kSpacing, kMaxSubdivisions)));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n - i; ++j) {
      const int k = n - i - j;
      const bool is_corner = i == n || j == n || k == n;
      const bool is_reversed = (k == 0 && index[0] > index[1]) || (i == 0 && index[1] > index[2]) ||
                               (j == 0 && index[2] > index[0]);
      if (is_corner || is_reversed) continue;
      visit(Eigen::Vector3d((i * corner[0] + j * corner[1] + k * corner[2]) / n));
    }
  }
}

Eigen::Vector3d area_normal(const Corners& corner) {
  return (corner[1] - corner[0]).cross(corner[2] - corner[0]);
}

}  // namespace

ScanPoints::ScanPoints(const ClosestSurface& surface, const PlanarState& start,
                       const TriangleMesh& static_mesh_base, const WorldOptions& options) {
  const Filter filter(surface, start, options);
  const auto& vertices = static_mesh_base.vertices;
  // Vertices without a triangle, of a surface that was removed, keep a normal of zero.
  std::vector<Eigen::Vector3d> normals(vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& triangle : static_mesh_base.triangles) {
    Corners corner;
    for (std::size_t i = 0; i < 3; ++i) corner[i] = vertices[triangle[i]].cast<double>();
    const Eigen::Vector3d normal = area_normal(corner);
    if (!(normal.squaredNorm() > 0.0)) continue;
    for (const std::uint32_t index : triangle) normals[index] += normal;
    const auto [low, high] = std::minmax({corner[0].z(), corner[1].z(), corner[2].z()});
    if (high < filter.low() || low > filter.high()) continue;
    const Eigen::Vector3d unit = normal.stableNormalized();
    visit_samples(corner, triangle, [&](const Eigen::Vector3d& p) {
      if (filter.is_obstacle(p, unit)) points_.push_back({p, unit.cast<float>()});
    });
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (normals[i].isZero(0.0)) continue;
    const Eigen::Vector3d p = vertices[i].cast<double>();
    const Eigen::Vector3d unit = normals[i].stableNormalized();
    if (filter.is_obstacle(p, unit)) points_.push_back({p, unit.cast<float>()});
  }
  sort_into_cells();
}

Eigen::Array2i ScanPoints::cell_of(const Eigen::Vector2d& p) const noexcept {
  const Eigen::Array2d cell = (p - bounds_.min()).array() / cell_;
  const Eigen::Array2d last(static_cast<double>(columns_ - 1), static_cast<double>(rows_ - 1));
  return cell.max(0.0).min(last).cast<int>();
}

void ScanPoints::sort_into_cells() {
  if (points_.empty()) return;
  for (const Point& point : points_) bounds_.extend(point.p_base.head<2>());
  cell_ = std::max(kMinCell, bounds_.sizes().maxCoeff() / kMaxCells);
  columns_ = static_cast<std::size_t>(bounds_.sizes().x() / cell_) + 1;
  rows_ = static_cast<std::size_t>(bounds_.sizes().y() / cell_) + 1;
  const auto key_of = [&](const Point& point) {
    const Eigen::Array2i cell = cell_of(point.p_base.head<2>());
    return static_cast<std::size_t>(cell.y()) * columns_ + static_cast<std::size_t>(cell.x());
  };
  // A counting sort: stable, so that the order depends on the mesh alone.
  starts_.assign(columns_ * rows_ + 1, 0);
  for (const Point& point : points_) ++starts_[key_of(point) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  std::vector<Point> sorted(points_.size());
  for (const Point& point : points_) sorted[next[key_of(point)]++] = point;
  points_ = std::move(sorted);
}

}  // namespace pcavr::detail
