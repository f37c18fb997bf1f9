// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/supports.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr::detail {
namespace {

Eigen::Vector2d slope_of(const Supports::Outline& corners, const Eigen::Vector3d& centroid) {
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  Eigen::Vector2d rise = Eigen::Vector2d::Zero();
  for (const Eigen::Vector3d& corner : corners) {
    const Eigen::Vector3d d = corner - centroid;
    scatter += d.head<2>() * d.head<2>().transpose();
    rise += d.z() * d.head<2>();
  }
  return scatter.inverse() * rise;
}

}  // namespace

Supports::Supports(const std::vector<Outline>& outlines_base, double height_tolerance)
    : height_tolerance_(height_tolerance) {
  PCAVR_REQUIRE(height_tolerance > 0.0, height_tolerance);
  for (const Outline& outline : outlines_base) {
    PCAVR_REQUIRE(outline.size() >= 3, outline.size());
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& corner : outline) {
      centroid += corner / static_cast<double>(outline.size());
    }
    supports_.push_back({outline, centroid, slope_of(outline, centroid)});
    PCAVR_REQUIRE(supports_.back().slope.allFinite(), centroid.x(), centroid.y(), centroid.z());
  }
}

double Supports::Support::height_at(const Eigen::Vector2d& p) const noexcept {
  return centroid.z() + slope.dot(p - centroid.head<2>());
}

bool Supports::is_level_with(const Support& support, const Eigen::Vector2d& p,
                             double bottom) const noexcept {
  return std::abs(support.height_at(p) - bottom) <= height_tolerance_;
}

bool Supports::Support::contains(const Eigen::Vector2d& p) const noexcept {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d a = corners[i].head<2>();
    const Eigen::Vector2d side = corners[(i + 1) % corners.size()].head<2>() - a;
    const Eigen::Vector2d to_p = p - a;
    if (side.x() * to_p.y() - side.y() * to_p.x() < 0.0) return false;
  }
  return true;
}

bool Supports::is_supported(const Eigen::Vector2d& p_base, double bottom) const noexcept {
  return std::any_of(supports_.begin(), supports_.end(), [&](const Support& support) {
    return is_level_with(support, p_base, bottom) && support.contains(p_base);
  });
}

std::optional<Supports::Edge> Supports::nearest_edge(const Eigen::Vector2d& p_base,
                                                     double bottom) const noexcept {
  std::optional<Edge> edge;
  double min_distance2 = std::numeric_limits<double>::infinity();
  for (const Support& support : supports_) {
    if (!is_level_with(support, p_base, bottom)) continue;
    for (std::size_t i = 0; i < support.corners.size(); ++i) {
      const Eigen::Vector3d& a = support.corners[i];
      const Eigen::Vector3d side = support.corners[(i + 1) % support.corners.size()] - a;
      const double length2 = side.head<2>().squaredNorm();
      if (!(length2 > 0.0)) continue;
      const double share = (p_base - a.head<2>()).dot(side.head<2>()) / length2;
      const Eigen::Vector3d nearest = a + std::clamp(share, 0.0, 1.0) * side;
      const double distance2 = (nearest.head<2>() - p_base).squaredNorm();
      if (distance2 >= min_distance2) continue;
      min_distance2 = distance2;
      edge = Edge{nearest, side.normalized()};
    }
  }
  return edge;
}

TriangleMesh Supports::surface_base() const {
  TriangleMesh mesh;
  for (const Support& support : supports_) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3d& corner : support.corners) {
      mesh.vertices.emplace_back(corner.cast<float>());
    }
    for (std::uint32_t i = 2; i < support.corners.size(); ++i) {
      mesh.triangles.push_back({first, first + i - 1, first + i});
    }
  }
  return mesh;
}

}  // namespace pcavr::detail
