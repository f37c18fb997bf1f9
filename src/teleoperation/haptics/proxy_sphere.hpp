// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"

#include "teleoperation/haptics/constrained_motion.hpp"
#include "teleoperation/haptics/triangle_tree.hpp"

namespace pcavr::detail {

/// The spherical god-object (virtual proxy) among surfaces, each at its latest pose: continuous
/// collision detection, so that its path never comes nearer than its radius to a triangle. All in
/// base axes [m]; only the constructor and `add` allocate.
class ProxySphere {
 public:
  explicit ProxySphere(double radius) : radius_(radius) {}

  /// Surfaces are numbered from 0. A static one has friction and is in base axes.
  void add_static(const TriangleMesh& mesh_base) { add(mesh_base, false); }
  void add_moving(const TriangleMesh& mesh_object) { add(mesh_object, true); }
  void set_pose(std::size_t surface, const Pose& T_base_object) noexcept;
  void remove(std::size_t surface) noexcept { surfaces_[surface].is_present = false; }

  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  void set_centre(const Eigen::Vector3d& centre) noexcept;
  [[nodiscard]] bool is_collision_free(const Eigen::Vector3d& centre) const noexcept;
  /// Whether a static surface lies between the proxy and `tip`, or a sphere at `tip` penetrates
  /// one.
  [[nodiscard]] bool is_separated_from(const Eigen::Vector3d& tip) const noexcept;

  /// Moves towards `goal` as far as the surfaces let it, in substeps of at most `max_substep` and
  /// on a path of at most `budget`. Updates the contacts.
  void follow(const Eigen::Vector3d& goal, double max_substep, double budget) noexcept;
  /// Moves towards `goal`, constrained by all surfaces but `surface`, which overlaps the proxy.
  void resolve_overlap(const Eigen::Vector3d& goal, std::size_t surface) noexcept;

  /// Whether `surface` blocks the proxy's motion to `goal`.
  [[nodiscard]] bool rests_on(std::size_t surface, const Eigen::Vector3d& goal) const noexcept;
  /// The mean normal of the static surfaces that block the proxy's motion to `tip`, of unit length;
  /// zero where none does.
  [[nodiscard]] Eigen::Vector3d static_normal(const Eigen::Vector3d& tip) const noexcept;
  /// Point to which the proxy would move towards `goal` on a path of at most `budget` without the
  /// moving surfaces, in the current half-spaces. Reduces `budget` by the length of that path.
  [[nodiscard]] Eigen::Vector3d centre_ignoring_moving(const Eigen::Vector3d& goal,
                                                       double& budget) noexcept;

 private:
  /// A sphere of 1 mm meets some 20 triangles of a fine scan in a cycle; where there are more, the
  /// cycle is divided into shorter substeps.
  static constexpr std::size_t kMaxTriangles = 192;

  struct Surface {
    TriangleTree tree;
    bool is_moving = false;
    bool is_present = true;
    Eigen::Matrix3d R_base_object = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_base_object = Eigen::Vector3d::Zero();

    [[nodiscard]] Eigen::Vector3d to_object(const Eigen::Vector3d& p) const noexcept {
      if (!is_moving) return p;
      return R_base_object.transpose() * (p - p_base_object);
    }
  };
  void add(const TriangleMesh& mesh, bool is_moving);
  void collect_triangles(const Eigen::Vector3d& at, double& substep) noexcept;
  [[nodiscard]] bool collect_within(const Eigen::Vector3d& at, double reach) noexcept;
  std::span<HalfSpace> build_half_spaces(const Eigen::Vector3d& at) noexcept;

  double radius_;
  std::vector<Surface> surfaces_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  std::size_t count_ = 0;  ///< of the collected triangles
  std::array<std::uint32_t, kMaxTriangles> triangles_;
  std::array<std::uint32_t, kMaxTriangles> surface_of_;  ///< surface of each triangle, ascending
  std::array<HalfSpace, kMaxTriangles> half_spaces_;
  std::array<HalfSpace, kMaxTriangles> selected_;  ///< work space
};

}  // namespace pcavr::detail
