// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/mesh.hpp"

#include "model/triangle.hpp"

namespace pcavr::detail {

/// Finds the triangles near a point: a binary tree of boxes, with the triangles of a leaf, and the
/// two halves of a node, side by side in memory. Const after construction.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh);

  struct Nearby {
    std::size_t count = 0;
    bool is_complete = true;  ///< false: there are more than fit
  };
  /// The triangles nearer than `reach` [m] to `p`, by their place in this tree, in a fixed order.
  [[nodiscard]] Nearby nearer_than(double reach, const Eigen::Vector3d& p,
                                   std::span<std::uint32_t> found) const noexcept;

  /// Whether a triangle is nearer than `reach` [m] to `p`.
  [[nodiscard]] bool is_near(double reach, const Eigen::Vector3d& p) const noexcept;
  /// Whether a triangle lies between `a` and `b`. What passes through an edge is a crossing too.
  [[nodiscard]] bool is_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const noexcept;

  [[nodiscard]] model::Triangle triangle(std::uint32_t place) const noexcept;

 private:
  /// Depth first through the boxes that `enter(low, high)` likes, until `visit(place)` says false.
  template <typename Enter, typename Visit>
  void traverse(const Enter& enter, const Visit& visit) const noexcept;

  using Corners = std::array<Eigen::Vector3f, 3>;
  struct Node {
    Eigen::Vector3f low;
    Eigen::Vector3f high;
    std::uint32_t first = 0;  ///< triangle of a leaf, or the first of two children
    std::uint32_t count = 0;  ///< triangles of a leaf; 0: not a leaf
  };
  void build(std::uint32_t node, std::span<std::uint32_t> order, std::uint32_t first,
             const std::vector<Corners>& unordered);

  std::vector<Node> nodes_;
  std::vector<Corners> triangles_;
};

}  // namespace pcavr::detail
