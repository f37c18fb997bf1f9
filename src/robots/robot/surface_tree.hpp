// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/robots/robot/robot_collision.hpp"

namespace pcavr::robot {

/// Distances of segments to the triangles of a mesh, by a bounding volume hierarchy. Const after
/// construction; queries do not allocate.
class SurfaceTree {
 public:
  explicit SurfaceTree(const TriangleMesh& mesh);

  /// The nearest triangle that is nearer than `best`, which is updated with it; else nothing.
  /// Points are in the mesh's frame.
  std::optional<std::uint32_t> find_nearer(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                           SegmentDistance& best) const noexcept;

  /// The distance to one triangle, as returned by find_nearer.
  [[nodiscard]] SegmentDistance distance_to(std::uint32_t triangle, const Eigen::Vector3d& a,
                                            const Eigen::Vector3d& b) const noexcept;

 private:
  struct Node {
    Eigen::AlignedBox3f box;
    std::uint32_t first = 0;  ///< triangle of a leaf, or the first of two children
    std::uint32_t count = 0;  ///< triangles of a leaf; 0: not a leaf
  };
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);

  std::vector<std::array<Eigen::Vector3f, 3>> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace pcavr::robot
