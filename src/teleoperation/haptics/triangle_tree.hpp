// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/model/triangle.hpp"

namespace pcavr::detail {

/// Finds the triangles near a point: a bounding volume hierarchy (BVH, a binary tree of
/// axis-aligned boxes), with a leaf's triangles, and a node's two children, contiguous in memory.
/// Const after construction.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh);

  struct Nearby {
    std::size_t count = 0;
    bool is_complete = true;  ///< false: more than fit into `found`
  };
  /// The triangles nearer than `reach` [m] to `p`, by their index in this tree, in a fixed order.
  [[nodiscard]] Nearby nearer_than(double reach, const Eigen::Vector3d& p,
                                   std::span<std::uint32_t> found) const noexcept;

  /// Whether a triangle is nearer than `reach` [m] to `p`.
  [[nodiscard]] bool is_near(double reach, const Eigen::Vector3d& p) const noexcept;
  /// Whether the segment from `a` to `b` intersects a triangle, edges included.
  [[nodiscard]] bool is_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const noexcept;

  [[nodiscard]] model::Triangle triangle(std::uint32_t index) const noexcept;

 private:
  /// Depth-first through the boxes for which `enter(low, high)` is true, until `visit(index)`
  /// returns false.
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
