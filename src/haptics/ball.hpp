// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"

#include "haptics/free_walk.hpp"
#include "haptics/triangle_tree.hpp"

namespace pcavr::detail {

/// A ball among surfaces, each where it was placed last: its path never brings it nearer than its
/// radius to a triangle. All in base axes [m]; nothing allocates but the constructor and `add`.
class Ball {
 public:
  explicit Ball(double radius) : radius_(radius) {}

  /// Surfaces count from 0. One that never moves bears friction and is in base axes.
  void add_static(const TriangleMesh& mesh_base) { add(mesh_base, false); }
  void add_moving(const TriangleMesh& mesh_object) { add(mesh_object, true); }
  void place(std::size_t surface, const Pose& T_base_object) noexcept;
  void remove(std::size_t surface) noexcept { surfaces_[surface].is_present = false; }

  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] const Eigen::Vector3d& centre() const { return centre_; }
  void put(const Eigen::Vector3d& centre) noexcept;
  [[nodiscard]] bool has_room(const Eigen::Vector3d& centre) const noexcept;
  /// Whether a surface that does not move lies between the ball and `tip`, or would be reached into
  /// by the ball there.
  [[nodiscard]] bool is_kept_apart(const Eigen::Vector3d& tip) const noexcept;

  /// Goes towards `goal` as far as the surfaces let it, in stretches of at most `stretch` and on a
  /// path of at most `budget`. What it touches is then known.
  void follow(const Eigen::Vector3d& goal, double stretch, double budget) noexcept;
  /// Goes towards `goal` past `surface`, which is in its place.
  void evade(const Eigen::Vector3d& goal, std::size_t surface) noexcept;

  /// Whether `surface` bears the ball on its way to `goal`.
  [[nodiscard]] bool rests_on(std::size_t surface, const Eigen::Vector3d& goal) const noexcept;
  /// The mean normal of the surfaces that do not move and bear the ball against `tip`, of unit
  /// length; zero where none does.
  [[nodiscard]] Eigen::Vector3d static_normal(const Eigen::Vector3d& tip) const noexcept;
  /// Where the ball would go towards `goal` on a path of at most `budget` if what moves were not
  /// there: in the half-spaces of what is near. Tells how much of the budget is left.
  [[nodiscard]] Eigen::Vector3d beyond_the_moving(const Eigen::Vector3d& goal,
                                                  double& budget) noexcept;

 private:
  /// A ball of 1 mm meets some 20 triangles of a fine scan in a cycle; where more are met, the
  /// cycle is walked in shorter stretches.
  static constexpr std::size_t kMaxTriangles = 192;

  struct Surface {
    TriangleTree tree;
    bool is_moving = false;
    bool is_present = true;
    Eigen::Matrix3d R_base_object = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p_base_object = Eigen::Vector3d::Zero();

    [[nodiscard]] Eigen::Vector3d to_own(const Eigen::Vector3d& p) const noexcept {
      if (!is_moving) return p;
      return R_base_object.transpose() * (p - p_base_object);
    }
  };
  void add(const TriangleMesh& mesh, bool is_moving);
  void gather(const Eigen::Vector3d& at, double& stretch) noexcept;
  [[nodiscard]] bool gather_all(const Eigen::Vector3d& at, double reach) noexcept;
  std::span<HalfSpace> draw(const Eigen::Vector3d& at) noexcept;

  double radius_;
  std::vector<Surface> surfaces_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  std::size_t count_ = 0;  ///< of the triangles gathered
  std::array<std::uint32_t, kMaxTriangles> places_;
  std::array<std::uint32_t, kMaxTriangles> owners_;  ///< ascending
  std::array<HalfSpace, kMaxTriangles> half_spaces_;
  std::array<HalfSpace, kMaxTriangles> some_;  ///< work space
};

}  // namespace pcavr::detail
