// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::detail {

/// The surfaces that bodies stand on: level polygons with an edge.
class Supports {
 public:
  using Outline = std::vector<Eigen::Vector3d>;
  /// Convex, counter-clockwise from above; at least three corners each. `height_tolerance` [m]
  /// between a support and the lowest point of a body that stands on it.
  Supports(const std::vector<Outline>& outlines_base, double height_tolerance);

  /// Whether a centre of mass at `p_base` [m] of a body whose lowest point is at height `bottom`
  /// [m] lies above one of them (static stability).
  [[nodiscard]] bool is_supported(const Eigen::Vector2d& p_base, double bottom) const noexcept;

  struct Edge {
    Eigen::Vector3d p_base = Eigen::Vector3d::Zero();  ///< its nearest point
    Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< unit length, the outside on its right
  };
  /// The edge nearest to such a point, of those at that height. Nothing where there is none.
  [[nodiscard]] std::optional<Edge> nearest_edge(const Eigen::Vector2d& p_base,
                                                 double bottom) const noexcept;

  /// All of them, as a collision mesh.
  [[nodiscard]] TriangleMesh surface_base() const;

 private:
  struct Support {
    Outline corners;
    Eigen::Vector3d centroid;
    Eigen::Vector2d slope;  ///< of its height over x and y

    [[nodiscard]] double height_at(const Eigen::Vector2d& p) const noexcept;
    [[nodiscard]] bool contains(const Eigen::Vector2d& p) const noexcept;
  };
  [[nodiscard]] bool is_level_with(const Support& support, const Eigen::Vector2d& p,
                                   double bottom) const noexcept;

  std::vector<Support> supports_;
  double height_tolerance_;
};

}  // namespace pcavr::detail
