// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::detail {

/// Signed distances to a closed surface, in double precision: in single precision the error would
/// be 0.1 um at 1 m, which a stiff contact turns into a force. A bounding volume hierarchy (BVH).
/// Const after construction; no allocation in queries.
class ClosestSurface {
 public:
  /// The surface of the mesh transformed by `T_frame_mesh`; results are in that frame.
  ClosestSurface(const TriangleMesh& mesh, const Pose& T_frame_mesh);

  struct Result {
    double distance = 0.0;  ///< [m] negative inside
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward, from the surface to p outside
  };
  /// Empty where `p` is outside and further than `reach` [m] from the bounding box or the surface.
  /// The sign is that of the angle-weighted normal of the feature that is closest
  /// [Baerentzen & Aanaes 2005].
  [[nodiscard]] std::optional<Result> closest(const Eigen::Vector3d& p,
                                              double reach) const noexcept;
  /// The same for a `p` that came in through a face with the outward normal `entry_normal`: inside,
  /// the point of that face that it lies behind, also where another face is closer, as near a
  /// corner [god-object: Zilles & Salisbury 1995]. As above where it is zero, and where `p` is not
  /// behind the inner part of such a face any more: it has slid around an edge.
  [[nodiscard]] std::optional<Result> closest(const Eigen::Vector3d& p, double reach,
                                              const Eigen::Vector3d& entry_normal) const noexcept;

  /// All points of the surface closer than `reach` [m] than which none in their neighbourhood is
  /// closer, as a sphere in a corner touches two walls: `closest` of `p` first; of two in
  /// directions less than 30 degrees apart the closer one. `p` outside. Returns how many were
  /// written: of a convex surface, or of one too fine within reach, the closest alone.
  [[nodiscard]] std::size_t local_minima(const Eigen::Vector3d& p, double reach,
                                         const Result& closest,
                                         std::span<Result> found) const noexcept;

  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return nodes_.front().box; }

 private:
  struct Triangle {
    std::array<Eigen::Vector3d, 3> corner;
    /// Normals by the closest feature: of the face, of the edges 01 12 20 and of the corners.
    std::array<Eigen::Vector3d, 7> normal;
    /// Normals of the edges in the triangle's plane, towards its inside, as long as the edges.
    std::array<Eigen::Vector3d, 3> inward;
  };
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;  ///< triangle of a leaf, or the first of two children
    std::uint32_t count = 0;  ///< triangles of a leaf; 0: not a leaf
  };
  struct Candidate;
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);
  /// `entry_normal`: only faces of about that normal that `p` is behind; null: all faces.
  void search(std::uint32_t node, const Eigen::Vector3d& p, const Eigen::Vector3d* entry_normal,
              Candidate& best) const noexcept;
  struct Neighbours;
  void gather(std::uint32_t node, const Eigen::Vector3d& p, double reach,
              Neighbours& near) const noexcept;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
  bool is_convex_;
};

}  // namespace pcavr::detail
