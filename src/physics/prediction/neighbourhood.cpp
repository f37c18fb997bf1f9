// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/neighbourhood.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/physics/friction/point_push.hpp"

namespace pcavr::detail {
namespace {

constexpr double kMargin = 1e-3;   // [m] contacts that may close within a step
constexpr double kSettled = 1e-8;  // [m] a smaller change does not affect neighbours
constexpr int kMaxSweeps = 12;     // bounds the time of a cycle where bodies do not settle
/// In the first sweeps a relative tolerance is enough for a body: its neighbours will move.
constexpr int kRoughSweeps = 6;
constexpr double kRoughTolerance = 0.1;
/// Largest disagreement of motions and forces in a step [m]: with more, the solver did not
/// converge.
constexpr double kMaxIslandResidual = 1e-5;
constexpr std::size_t kMaxSides = 64;    // of one body: eight neighbours of eight points
constexpr double kMinCoefficient = 0.1;  // of friction, for the stiffness of a contact without any

double rotation_between(const PlanarState& from, const PlanarState& to) {
  return to.yaw - from.yaw;
}

Eigen::Vector2d displacement_of(const PlanarState& from, const PlanarState& to,
                                const Eigen::Vector2d& arm) {
  const double rotation = rotation_between(from, to);
  return to.position - from.position + Eigen::Vector2d(-rotation * arm.y(), rotation * arm.x());
}

double speed_of(const UprightBody& body, const BodyState& state) {
  return state.planar.twist.head<2>().norm() +
         2.0 * body.gyration_radius() * std::abs(state.planar.twist.z());
}

/// Whether the state is that in which a step leaves a body at rest, farther from the tip than
/// contacts are searched: the next step would change nothing.
bool is_left_alone(const BodyState& state) {
  return state.phase == MotionPhase::free && state.planar.phase == FrictionPhase::static_contact &&
         state.planar.twist.isZero(0.0) && state.penetration == TipContact{}.depth &&
         state.tool_force_base.isZero(0.0) && state.tangential_deflection_base.isZero(0.0) &&
         state.grip_count == 0 && !state.is_saturated;
}

/// Whether the tip pushes with more than the static friction limit.
bool is_pressed(const UprightBody& body, const BodyState& state) {
  return state.tool_force_base.head<2>().norm() > static_friction_limit(body.physics().friction);
}

/// The state at the begin, but at rest.
BodyState stopped(const UprightBody& body, const BodyState& begin, const TipPath& tip) {
  BodyState end = begin;
  end.planar.twist.setZero();
  end.penetration = TipContact{}.depth;
  if (!tip.is_present) return end;
  if (const auto contact =
          find_tip_contact(body, end.planar, tip.to, tip.radius, end.entry_normal)) {
    end.penetration = contact->depth;
  }
  return end;
}

/// The stiffness for the larger force at which one of the two breaks loose.
double stiffness_between(const BodyPhysics& a, const BodyPhysics& b, double penetration) {
  const double light =
      kStandardGravity * kMinCoefficient * std::min(a.friction.mass, b.friction.mass);
  return std::max({static_friction_limit(a.friction), static_friction_limit(b.friction), light}) /
         penetration;
}

}  // namespace

Neighbourhood::Neighbourhood(const std::vector<WorldBody>& bodies,
                             const std::vector<UprightBody>& upright,
                             const TriangleMesh& static_mesh_base, const WorldOptions& options)
    : options_(options),
      collider_(bodies, upright, static_mesh_base, options),
      members_(bodies.size()) {
  for (Member& member : members_) {
    member.sides.reserve(kMaxSides);
    member.partners.reserve(kMaxSides);
  }
  queue_.reserve(bodies.size());
  points_.reserve(Collider::kMaxPoints);
}

void Neighbourhood::step(const std::vector<UprightBody>& bodies, const TipPath& tip, double dt,
                         std::vector<BodyState>& states) {
  for (std::size_t i = 0; i < bodies.size(); ++i) members_[i].start = states[i].planar;
  find_contacts(bodies, tip, dt, states);
  step_contacts(bodies, tip, dt, states);
  keep_out_of_scan(bodies, tip, dt, states);
}

void Neighbourhood::step_contacts(const std::vector<UprightBody>& bodies, const TipPath& tip,
                                  double dt, std::vector<BodyState>& states) {
  bool is_together = false;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!states[i].is_present) continue;
    if (!members_[i].sides.empty()) {
      is_together = true;
      continue;
    }
    if (members_[i].is_out_of_reach && is_left_alone(states[i])) continue;
    TipPath substep = tip;
    const int substeps = count_substeps(bodies[i], states[i], tip, dt);
    for (int k = 1; k <= substeps; ++k) {
      substep.to = tip.from + (static_cast<double>(k) / substeps) * (tip.to - tip.from);
      states[i] = step_body(bodies[i], states[i], substep, {}, dt / substeps).state;
      substep.from = substep.to;
    }
  }
  if (!is_together) return;
  for (std::size_t i = 0; i < bodies.size(); ++i) members_[i].begin = states[i];
  step_together(bodies, tip, dt);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!members_[i].sides.empty()) states[i] = members_[i].end;
  }
}

/// Starts at the bodies that move, or that the tip may move, and continues to those in contact with
/// them (builds the island).
void Neighbourhood::find_contacts(const std::vector<UprightBody>& bodies, const TipPath& tip,
                                  double dt, const std::vector<BodyState>& states) {
  queue_.clear();
  max_static_friction_ = 0.0;
  const double travel = (tip.to - tip.from).head<2>().norm();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].is_movable()) {
      max_static_friction_ =
          std::max(max_static_friction_, static_friction_limit(bodies[i].physics().friction));
    }
    Member& member = members_[i];
    member.sides.clear();
    member.partners.clear();
    member.is_searched = false;
    member.is_awake = false;
    if (!states[i].is_present) continue;
    const double near = collider_.reach(i) + tip.radius + travel + kMargin;
    const double distance = (tip.to.head<2>() - states[i].planar.position).norm();
    const bool is_touched = tip.is_present && distance < near;
    member.is_out_of_reach = !tip.is_present || distance > near + kMaxClearance;
    member.is_awake = bodies[i].is_movable() && (is_touched || !states[i].planar.twist.isZero(0.0));
    if (member.is_awake) queue_.push_back(i);
  }
  for (std::size_t i = 0; i < queue_.size(); ++i) search(queue_[i], bodies, dt, states);
}

void Neighbourhood::search(std::size_t body, const std::vector<UprightBody>& bodies, double dt,
                           const std::vector<BodyState>& states) {
  const PlanarState& own = states[body].planar;
  const double speed = speed_of(bodies[body], states[body]);
  points_.clear();
  collider_.with_static(body, own, points_);
  for (const CollisionPoint& point : points_) link(body, -1, point, 1.0, bodies, states);
  for (std::size_t other = 0; other < bodies.size(); ++other) {
    if (other == body || members_[other].is_searched || !states[other].is_present) continue;
    const double margin = kMargin + dt * (speed + speed_of(bodies[other], states[other]));
    const double apart = (states[other].planar.position - own.position).norm();
    if (apart > collider_.reach(body) + collider_.reach(other) + margin) continue;
    points_.clear();
    collider_.between(body, own, other, states[other].planar, margin, points_);
    if (!bodies[other].is_movable()) {  // like the static mesh
      for (const CollisionPoint& point : points_) link(body, -1, point, 1.0, bodies, states);
      continue;
    }
    for (const CollisionPoint& point : points_) {
      link(body, static_cast<std::ptrdiff_t>(other), point, 1.0, bodies, states);
      link(other, static_cast<std::ptrdiff_t>(body), point, -1.0, bodies, states);
    }
    if (!points_.empty() && !members_[other].is_awake) {
      members_[other].is_awake = true;
      queue_.push_back(other);
    }
  }
  members_[body].is_searched = true;
}

/// `sign`: 1 for the first of the two that the point was found between.
void Neighbourhood::link(std::size_t body, std::ptrdiff_t partner, const CollisionPoint& point,
                         double sign, const std::vector<UprightBody>& bodies,
                         const std::vector<BodyState>& states) {
  Member& member = members_[body];
  if (member.sides.size() == kMaxSides) return;
  const BodyPhysics& own = bodies[body].physics();
  const BodyPhysics& other =
      partner < 0 ? own : bodies[static_cast<std::size_t>(partner)].physics();
  SideContact side;
  side.normal = (sign * point.normal.head<2>()).normalized();
  side.arm = point.p_base.head<2>() - states[body].planar.position;
  // Horizontally an overlap is larger than along a normal that is not horizontal.
  side.depth = point.depth / point.normal.head<2>().norm();
  side.stiffness = stiffness_between(own, other, options_.body_penetration);
  // The static mesh has to support a light body that a heavy one, or a tool that can push the
  // heavy one, presses against it.
  if (partner < 0) {
    side.stiffness = std::max(side.stiffness, max_static_friction_ / options_.body_penetration);
  }
  side.damping = 2.0 * std::sqrt(side.stiffness * std::min(own.friction.mass, other.friction.mass));
  side.friction = options_.body_friction;
  side.max_separation_speed = options_.max_separation_speed;
  Partner opposite;
  opposite.body = partner;
  if (partner >= 0) {
    opposite.arm =
        point.p_base.head<2>() - states[static_cast<std::size_t>(partner)].planar.position;
  }
  member.sides.push_back(side);
  member.partners.push_back(opposite);
}

void Neighbourhood::step_together(const std::vector<UprightBody>& bodies, const TipPath& tip,
                                  double dt) {
  int substeps = 1;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (members_[i].sides.empty()) continue;
    substeps = std::max(substeps, count_substeps(bodies[i], members_[i].begin, tip, dt));
  }
  const double time = dt / substeps;
  TipPath substep = tip;
  for (int k = 1; k <= substeps; ++k) {
    substep.to = tip.from + (static_cast<double>(k) / substeps) * (tip.to - tip.from);
    for (Member& member : members_) {
      member.is_dirty = !member.sides.empty();
      member.end = member.begin;
      member.end.planar.position += time * member.begin.planar.twist.head<2>();
      member.end.planar.yaw += time * member.begin.planar.twist.z();
    }
    for (Member& member : members_) update_closing_speeds(member);
    bool is_settled = false;
    for (int sweep = 0; sweep < kMaxSweeps && !is_settled; ++sweep) {
      is_settled = true;
      for (std::size_t i = 0; i < members_.size();
           ++i) {  // symmetric Gauss-Seidel: forward, then backward
        const std::size_t body = sweep % 2 == 0 ? i : members_.size() - 1 - i;
        const double relative_tolerance = sweep < kRoughSweeps ? kRoughTolerance : 0.0;
        if (!members_[body].is_dirty) continue;
        if (solve(body, bodies, substep, time, relative_tolerance)) is_settled = false;
      }
    }
    for (std::size_t i = 0; i < members_.size(); ++i) {
      Member& member = members_[i];
      if (member.sides.empty() || member.residual <= kMaxIslandResidual) continue;
      member.end = stopped(bodies[i], member.begin, substep);
    }
    for (Member& member : members_) {
      update_neighbour_displacements(member);
      for (SideContact& side : member.sides) {
        side.depth +=
            side.normal.dot(side.neighbour_displacement -
                            displacement_of(member.begin.planar, member.end.planar, side.arm));
      }
    }
    for (Member& member : members_) member.begin = member.end;
    substep.from = substep.to;
  }
}

/// Whether it moved enough for itself and its neighbours to be solved again.
bool Neighbourhood::solve(std::size_t body, const std::vector<UprightBody>& bodies,
                          const TipPath& tip, double dt, double relative_tolerance) {
  Member& member = members_[body];
  update_neighbour_displacements(member);
  const PlanarState before = member.end.planar;
  const BodyStep step =
      step_body(bodies[body], member.begin, tip, member.sides, dt, &before, relative_tolerance);
  member.end = step.state;
  member.is_dirty = false;
  const double change =
      (member.end.planar.position - before.position).norm() +
      bodies[body].gyration_radius() * std::abs(rotation_between(before, member.end.planar));
  member.residual = std::max(step.residual, change);
  if (change <= kSettled) return false;
  member.is_dirty = true;
  for (const Partner& partner : member.partners) {
    if (partner.body >= 0) members_[static_cast<std::size_t>(partner.body)].is_dirty = true;
  }
  return true;
}

/// The contacts' springs hold a body out of the scan where the solver converges and where they
/// are found; this holds it under any force: a motion that would bring a scan point too deep into a
/// body ends before.
void Neighbourhood::keep_out_of_scan(const std::vector<UprightBody>& bodies, const TipPath& tip,
                                     double dt, std::vector<BodyState>& states) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    BodyState& state = states[i];
    const PlanarState& start = members_[i].start;
    state.is_blocked = false;
    if (!state.is_present || !bodies[i].is_movable()) continue;
    const bool has_moved = state.planar.position != start.position || state.planar.yaw != start.yaw;
    const double share = has_moved ? collider_.collision_free_share(i, start, state.planar) : 1.0;
    if (share < 1.0) {
      state.planar.position = start.position + share * (state.planar.position - start.position);
      state.planar.yaw = start.yaw + share * (state.planar.yaw - start.yaw);
      state = stop_body(bodies[i], state, tip, dt);
    }
    state.is_blocked =
        share < 1.0 || (state.phase != MotionPhase::sliding && is_against_static(members_[i]) &&
                        is_pressed(bodies[i], state));
  }
}

bool Neighbourhood::is_against_static(const Member& member) const {
  for (std::size_t i = 0; i < member.sides.size(); ++i) {
    if (member.partners[i].body < 0 && member.sides[i].depth > 0.0) return true;
  }
  return false;
}

void Neighbourhood::update_closing_speeds(Member& member) const {
  for (std::size_t i = 0; i < member.sides.size(); ++i) {
    const Partner& partner = member.partners[i];
    SideContact& side = member.sides[i];
    Eigen::Vector2d slip = -velocity_of(side.arm, member.begin.planar.twist);
    if (partner.body >= 0) {
      const Member& other = members_[static_cast<std::size_t>(partner.body)];
      slip += velocity_of(partner.arm, other.begin.planar.twist);
    }
    side.closing = side.normal.dot(slip);
  }
}

void Neighbourhood::update_neighbour_displacements(Member& member) const {
  for (std::size_t i = 0; i < member.sides.size(); ++i) {
    const Partner& partner = member.partners[i];
    if (partner.body < 0) continue;
    const Member& other = members_[static_cast<std::size_t>(partner.body)];
    member.sides[i].neighbour_displacement =
        displacement_of(other.begin.planar, other.end.planar, partner.arm);
  }
}

}  // namespace pcavr::detail
