// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr::detail {

/// What bodies stand on: level faces with an edge.
class Supports {
 public:
  using Outline = std::vector<Eigen::Vector3d>;
  /// Convex, counter-clockwise from above; at least three corners each.
  explicit Supports(const std::vector<Outline>& outlines_base);

  /// Whether a centre of mass at `p_base` [m] of a body whose lowest point is at height `foot` [m]
  /// lies above one of them.
  [[nodiscard]] bool bear(const Eigen::Vector2d& p_base, double foot) const noexcept;

  struct Edge {
    Eigen::Vector3d p_base = Eigen::Vector3d::Zero();  ///< the point of it that is nearest
    Eigen::Vector3d along = Eigen::Vector3d::UnitX();  ///< unit length, the outside on its right
  };
  /// The edge nearest to such a point, of those at that height. Nothing where there is none.
  [[nodiscard]] std::optional<Edge> nearest_edge(const Eigen::Vector2d& p_base,
                                                 double foot) const noexcept;

  /// All of them, as a ball meets them.
  [[nodiscard]] TriangleMesh surface_base() const;

 private:
  struct Support {
    Outline corners;
    Eigen::Vector3d middle;
    Eigen::Vector2d slope;  ///< of its height over x and y

    [[nodiscard]] bool is_level_with(const Eigen::Vector2d& p, double foot) const noexcept;
    [[nodiscard]] bool contains(const Eigen::Vector2d& p) const noexcept;
  };
  std::vector<Support> supports_;
};

}  // namespace pcavr::detail
