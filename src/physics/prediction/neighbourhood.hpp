// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "physics/prediction/body_step.hpp"
#include "physics/prediction/collider.hpp"

namespace pcavr::detail {

/// Contact solver: steps all bodies of a world, those in contact with each other together (a
/// simulation island), by Gauss-Seidel sweeps over the bodies. Between steps it keeps no state,
/// only work space.
class Neighbourhood {
 public:
  /// `upright` are the same bodies; they must outlive it.
  Neighbourhood(const std::vector<WorldBody>& bodies, const std::vector<UprightBody>& upright,
                const TriangleMesh& static_mesh_base, const WorldOptions& options);

  [[nodiscard]] bool has_shape(std::size_t body) const { return collider_.has_shape(body); }
  void step(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt,
            std::vector<BodyState>& states);

 private:
  /// The other side of a SideContact.
  struct Partner {
    std::ptrdiff_t body = -1;  ///< -1: the static mesh
    Eigen::Vector2d arm = Eigen::Vector2d::Zero();
  };
  /// A body during a step.
  struct Member {
    bool is_awake = false;         ///< active: it moves, or something may move it
    bool is_out_of_reach = false;  ///< of the tip, and of the clearances that are computed
    bool is_searched = false;      ///< its contacts are known
    bool is_dirty = false;         ///< a neighbour moved since it was solved
    double residual = 0.0;         ///< [m] between its motion and the one its forces cause
    PlanarState start;             ///< at the begin of the whole step
    BodyState begin;               ///< of a substep
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
  void step_contacts(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt,
                     std::vector<BodyState>& states);
  void step_together(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt);
  [[nodiscard]] bool solve(std::size_t body, const std::vector<UprightBody>& bodies,
                           const TipPath& tip, double dt, double relative_tolerance);
  void keep_out_of_scan(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt,
                        std::vector<BodyState>& states);
  [[nodiscard]] bool is_against_static(const Member& member) const;
  void update_closing_speeds(Member& member) const;
  void update_neighbour_displacements(Member& member) const;

  WorldOptions options_;
  Collider collider_;
  std::vector<Member> members_;
  std::vector<std::size_t> queue_;
  std::vector<CollisionPoint> points_;
  double max_static_friction_ = 0.0;  ///< [N] of all bodies
};

}  // namespace pcavr::detail
