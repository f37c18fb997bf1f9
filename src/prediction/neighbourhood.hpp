// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "prediction/body_step.hpp"
#include "prediction/collider.hpp"

namespace pcavr::detail {

/// Steps all bodies of a world, those that touch each other together. What it holds between steps
/// is work space only.
class Neighbourhood {
 public:
  Neighbourhood(const std::vector<WorldBody>& bodies, const TriangleMesh& static_mesh_base);

  [[nodiscard]] bool has_shape(std::size_t body) const { return collider_.has_shape(body); }
  void step(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt,
            std::vector<BodyState>& states);

 private:
  /// The other side of a SideContact.
  struct Partner {
    std::ptrdiff_t body = -1;  ///< -1: it stands still
    Eigen::Vector2d arm = Eigen::Vector2d::Zero();
  };
  /// A body, while a step is under way.
  struct Member {
    bool is_awake = false;     ///< it moves, or something may move it
    bool is_searched = false;  ///< its contacts are known
    bool is_dirty = false;     ///< a neighbour moved since it was solved
    double unsolved = 0.0;     ///< [m] by which its motion is not that of the forces on it
    BodyState begin;
    BodyState end;
    std::vector<SideContact> sides;
    std::vector<Partner> partners;
  };

  void find_contacts(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt,
                     const std::vector<BodyState>& states);
  void search(std::size_t body, const std::vector<UprightBody>& bodies, double dt,
              const std::vector<BodyState>& states);
  void link(std::size_t body, std::ptrdiff_t partner, const CollisionPoint& point, double sign,
            const std::vector<UprightBody>& bodies, const std::vector<BodyState>& states);
  void step_together(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt);
  [[nodiscard]] bool solve(std::size_t body, const std::vector<UprightBody>& bodies,
                           const TipPath& tip, double dt, double enough_share);
  void tell_speeds(Member& member) const;
  void follow_neighbours(Member& member) const;

  Collider collider_;
  std::vector<Member> members_;
  std::vector<std::size_t> queue_;
  std::vector<CollisionPoint> points_;
  double strongest_ = 0.0;  ///< [N] that any of the bodies withstands
};

}  // namespace pcavr::detail
