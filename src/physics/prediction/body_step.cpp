// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/prediction/body_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "physics/prediction/held_body.hpp"
#include "physics/prediction/push_out.hpp"

namespace pcavr::detail {
namespace {

/// A step has converged where the contacts' forces and the motion that they cause agree to this
/// share of F_M, far below the resolution of a force sensor; or the motion to this [m]. Contacts
/// that the motion has not closed yet have no force: so the motion has to agree to kMaxResidual, in
/// any case.
constexpr double kForceTolerance = 3e-4;
constexpr double kDisplacementTolerance = 1e-10;
constexpr double kMaxResidual = 1e-6;
constexpr int kMaxIterations = 24;  // bounds a cycle's time where contacts open and close
/// Smallest share of a step that is simulated: a shorter remainder is left for the next step.
constexpr double kMinShareOfStep = 1e-3;
/// phases.csv, with hysteresis: sliding above the one speed until below the other [m/s].
constexpr double kSlidingSpeed = 1e-3;
constexpr double kStoppedSpeed = 0.3e-3;

/// Share of the maximum force from which on the force counts as limited by the law, within
/// rounding.
constexpr double kSaturatedShare = 0.999;

/// Cosine between the normals of one face at the begin and at the end of a step.
constexpr double kSameFace = 0.9;

/// All forces but the support's friction on the body in one configuration.
struct Load {
  TipContacts contacts;
  std::array<TipForce, BodyState::kMaxGrips> tips = {};  ///< of each contact
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  /// Decrease of the wrench as the body moves, in the axes x, y and gyration radius times yaw.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();

  [[nodiscard]] Eigen::Vector3d tip_force() const {
    Eigen::Vector3d sum = tips[0].force;
    for (int i = 1; i < contacts.count; ++i) sum += tips[static_cast<std::size_t>(i)].force;
    return sum;
  }
  [[nodiscard]] double down() const { return -tip_force().z(); }
};

/// A contact at the begin of the step.
struct ContactBegin {
  double depth = 0.0;                                    ///< [m]
  Eigen::Vector3d deflection = Eigen::Vector3d::Zero();  ///< [m]
};

/// Displacement of the body since the step's begin.
struct Displacement {
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();
  double turned = 0.0;

  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& arm) const {
    return {moved.x() - turned * arm.y(), moved.y() + turned * arm.x()};
  }
};

class BodyStepper {
 public:
  BodyStepper(const UprightBody& body, const BodyState& state, const TipPath& tip,
              std::span<const SideContact> sides, double dt, const PlanarState* guess,
              double relative_tolerance) noexcept
      : body_(body),
        state_(state),
        tip_(tip),
        sides_(sides),
        guess_(guess),
        relative_tolerance_(relative_tolerance),
        dt_(dt) {
    if ((tip.to - tip.from).norm() > tip.max_speed * dt) tip_.from = tip.to;
    contacts_ = contacts_at(state.planar, tip_.from);
    // Weight of the step's end in the contact's mean depth: the midpoint rule, which is of second
    // order, for contacts that the step resolves; nearly implicit Euler for those that it does not,
    // so that they do not oscillate (numerical damping).
    const double stiffness_ratio =
        dt * dt * body.working_stiffness() / body.physics().friction.mass;
    end_share_ = 0.5 + 0.5 * stiffness_ratio / (4.0 + stiffness_ratio);
  }

  BodyStep run() noexcept {
    resolve_overlap();
    // Friction is computed for the force at the begin: over a step it hardly changes, and in every
    // Newton iteration it would cost as much as the rest.
    friction_ = friction_at_begin();
    if (!body_.is_movable()) {
      finish(state_.planar, load_at_rest(1.0), 0.0);
    } else if (state_.planar.twist.isZero(0.0)) {
      stick();
    } else {
      slide();
    }
    return {state_, residual_};
  }

  BodyState stop() noexcept {
    state_.planar.twist.setZero();
    friction_ = friction_at_begin();
    const Load load = load_at_rest(1.0);
    finish(state_.planar, load, static_load_ratio(load));
    return state_;
  }

 private:
  [[nodiscard]] TipContacts contacts_at(const PlanarState& planar,
                                        const Eigen::Vector3d& tip) const noexcept {
    if (!tip_.is_present) return {};
    return find_tip_contacts(body_, planar, tip, tip_.radius, state_.entry_normal);
  }

  [[nodiscard]] PlanarFriction friction_at_begin() const noexcept {
    const TipContact& contact = contacts_.deepest();
    return body_.friction_under(state_.tool_force_base, contact.arm, contact.height,
                                state_.planar.yaw);
  }

  /// The state at the begin of the contact number `index` of `contacts`: that of the contact with
  /// the same normal. A face that was not touched then is penetrated at the speed of the tip's
  /// `displacement` relative to it [m]: by the surface's offset, the depths of two faces differ
  /// where they meet.
  [[nodiscard]] ContactBegin begin_of(const TipContacts& contacts, std::size_t index,
                                      const Eigen::Vector3d& displacement) const noexcept {
    const Eigen::Vector3d& normal = contacts.all[index].normal;
    const bool is_single = contacts.count == 1 && contacts_.count == 1 && state_.grip_count == 0;
    if (is_single && contacts_.deepest().normal.dot(normal) > kSameFace) {
      return {contacts_.deepest().depth, state_.tangential_deflection_base};
    }
    ContactBegin begin;
    begin.depth = contacts.all[index].depth + normal.dot(displacement);
    double max_cosine = kSameFace;
    for (int i = 0; i < contacts_.count; ++i) {
      const TipContact& contact = contacts_.all[static_cast<std::size_t>(i)];
      if (!(contact.normal.dot(normal) > max_cosine)) continue;
      max_cosine = contact.normal.dot(normal);
      begin.depth = contact.depth;
    }
    if (state_.grip_count == 0) {
      const bool is_deepest = contacts_.deepest().normal.dot(normal) > kSameFace;
      if (is_deepest) begin.deflection = state_.tangential_deflection_base;
      return begin;
    }
    max_cosine = kSameFace;
    for (int i = 0; i < state_.grip_count; ++i) {
      const TipGrip& grip = state_.grips[static_cast<std::size_t>(i)];
      if (!(grip.normal_base.dot(normal) > max_cosine)) continue;
      max_cosine = grip.normal_base.dot(normal);
      begin.deflection = grip.tangential_deflection_base;
    }
    return begin;
  }

  /// A tip that something else holds deeper in the body has no face: it could not get there.
  void keep_entry(const TipContact& deepest) noexcept {
    state_.entry_normal.setZero();
    const bool is_near = deepest.depth > -kMaxClearance;
    if (!is_near || deepest.depth > body_.max_entry_depth()) return;
    state_.entry_normal = deepest.normal;
    state_.entry_normal.head<2>() =
        Eigen::Rotation2Dd(-state_.planar.yaw) * deepest.normal.head<2>();
  }

  void keep_grips(const Load& load) noexcept {
    state_.tangential_deflection_base = load.tips[0].deflection;
    state_.grip_count = load.contacts.count > 1 ? load.contacts.count : 0;
    for (int i = 0; i < state_.grip_count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      state_.grips[k] = {load.contacts.all[k].normal, load.tips[k].deflection};
    }
  }

  /// A pose or a tip that was set from outside may penetrate deeper than any force allows: then the
  /// body is moved to where a slow push would have brought it.
  void resolve_overlap() noexcept {
    if (!body_.is_movable() || !(contacts_.deepest().depth > 0.0)) return;
    const double allowed = std::max(state_.penetration, body_.static_limit_depth());
    if (!(contacts_.deepest().depth > allowed + 1e-8)) return;
    state_.planar = pushed_out(body_, state_.planar, tip_.from, tip_.radius, state_.entry_normal);
    contacts_ = contacts_at(state_.planar, tip_.from);
    state_.planar.twist.setZero();
    state_.tangential_deflection_base.setZero();
    state_.grip_count = 0;
  }

  void add_sides(const Displacement& own, double share, Load& load) const noexcept {
    for (const SideContact& side : sides_) {
      const Eigen::Vector2d slip = share * side.neighbour_displacement - own.at(side.arm);
      const SideForce response = side_force(side, slip, share * dt_);
      if (response.force.isZero(0.0)) continue;
      load.wrench += wrench_at(side.arm, {response.force.x(), response.force.y(), 0.0});
      load.stiffness += body_stiffness(response.stiffness, side.arm);
    }
  }

  /// Transforms a stiffness at a point to the body's motion.
  [[nodiscard]] Eigen::Matrix3d body_stiffness(const Eigen::Matrix2d& stiffness,
                                               const Eigen::Vector2d& arm) const noexcept {
    const Eigen::Vector2d turning = Eigen::Vector2d(-arm.y(), arm.x()) / body_.gyration_radius();
    const Eigen::Vector2d mixed = stiffness * turning;
    Eigen::Matrix3d result;
    result.topLeftCorner<2, 2>() = stiffness;
    result.topRightCorner<2, 1>() = mixed;
    result.bottomLeftCorner<1, 2>() = mixed.transpose();
    result(2, 2) = turning.dot(mixed);
    return result;
  }

  /// The load with the body at rest, and tip and neighbours after a share of their displacement.
  [[nodiscard]] Load load_at_rest(double share) const noexcept {
    Load load;
    const Eigen::Vector3d displacement = share * (tip_.to - tip_.from);
    load.contacts = contacts_at(state_.planar, tip_.from + displacement);
    const double time = share * dt_;
    for (std::size_t i = 0; i < static_cast<std::size_t>(load.contacts.count); ++i) {
      const TipContact& contact = load.contacts.all[i];
      const ContactBegin begin = begin_of(load.contacts, i, displacement);
      const double rate = time > 0.0 ? (contact.depth - begin.depth) / time : 0.0;
      Eigen::Vector3d deflection = Eigen::Vector3d::Zero();
      if (begin.depth > 0.0) deflection = begin.deflection + displacement;
      load.tips[i] = tip_force(body_, tip_.radius, contact.normal, contact.depth, rate, deflection,
                               (tip_.to - tip_.from) / dt_);
      load.wrench += wrench_at(contact.arm, load.tips[i].force);
    }
    if (time > 0.0) add_sides({}, share, load);
    return load;
  }

  /// The load relative to the limit of static friction: above 1 the body breaks loose.
  [[nodiscard]] double static_load_ratio(const Load& load) const noexcept {
    if (load.wrench.isZero(0.0)) return 0.0;
    return body_.level_of(friction_, state_.planar.yaw, load.wrench) /
           (body_.weight_share(load.down()) * std::max(friction_.static_to_kinetic_ratio, 1.0));
  }

  void stick() noexcept {
    const Load load = load_at_rest(1.0);
    const double load_ratio = static_load_ratio(load);
    if (load_ratio > 1.0 && break_loose(load_ratio)) return;
    finish(state_.planar, load, load_ratio);
  }

  /// Finds the instant at which the load exceeds the static limit, and slides from there. False
  /// where too little of the step is left.
  bool break_loose(double load_ratio_at_end) noexcept {
    double low = 0.0;
    double high = 1.0;
    double low_excess = static_load_ratio(load_at_rest(low)) - 1.0;
    double high_excess = load_ratio_at_end - 1.0;
    // Steps with neighbours' contacts are not split: their loads build up within a few steps.
    if (low_excess > 0.0 || !sides_.empty()) high = 0.0;
    // Regula falsi, Illinois variant.
    for (int i = 0; i < 6 && high - low > kMinShareOfStep; ++i) {
      const double at = low + (high - low) * low_excess / (low_excess - high_excess);
      const double excess = static_load_ratio(load_at_rest(at)) - 1.0;
      if (excess > 0.0) {
        high = at;
        high_excess = excess;
        low_excess *= 0.5;
      } else {
        low = at;
        low_excess = excess;
        high_excess *= 0.5;
      }
    }
    if (1.0 - high < kMinShareOfStep) return false;
    if (high > 0.0) {
      const Load load = load_at_rest(high);
      keep_grips(load);
      contacts_ = load.contacts;
      tip_.from += high * (tip_.to - tip_.from);
      dt_ *= 1.0 - high;
    }
    slide();
    return true;
  }

  /// The load with the body's end at `planar`; `end_share` is 1 for the load there, less for its
  /// mean over the step.
  [[nodiscard]] Load load_at(const PlanarState& planar, const TipContacts& contacts,
                             double end_share) const noexcept {
    Load load;
    load.contacts = contacts;
    const Displacement own{planar.position - state_.planar.position,
                           planar.yaw - state_.planar.yaw};
    for (std::size_t i = 0; i < static_cast<std::size_t>(contacts.count); ++i) {
      const TipContact& contact = contacts.all[i];
      Eigen::Vector3d slip = tip_.to - tip_.from;
      slip.head<2>() -= own.at(contact.arm);
      const ContactBegin at_begin = begin_of(contacts, i, slip);
      if (!(contact.depth > 0.0 || at_begin.depth > 0.0)) continue;
      const double begin = std::max(at_begin.depth, 0.0);
      const double end = end_share < 1.0 ? std::max(contact.depth, 0.0) : contact.depth;
      Eigen::Vector3d deflection = end_share * slip;
      if (at_begin.depth > 0.0) deflection += at_begin.deflection;
      load.tips[i] =
          tip_force(body_, tip_.radius, contact.normal, begin + end_share * (end - begin),
                    (contact.depth - at_begin.depth) / dt_, deflection, slip / dt_);
      load.wrench += wrench_at(contact.arm, load.tips[i].force);
      load.stiffness +=
          body_stiffness(flat_stiffness(load.tips[i], contact.normal.head<2>()), contact.arm);
    }
    add_sides(own, 1.0, load);
    return load;
  }

  [[nodiscard]] Eigen::Matrix2d flat_stiffness(const TipForce& tip,
                                               const Eigen::Vector2d& normal) const noexcept {
    const double along = end_share_ * tip.normal_stiffness + tip.normal_damping / dt_;
    const double across = end_share_ * tip.tangential_stiffness + tip.tangential_damping / dt_;
    return across * Eigen::Matrix2d::Identity() + (along - across) * normal * normal.transpose();
  }

  [[nodiscard]] Eigen::Vector3d scaled(const PlanarState& planar) const noexcept {
    return {planar.position.x(), planar.position.y(), body_.gyration_radius() * planar.yaw};
  }

  void move(PlanarState& planar, const Eigen::Vector3d& displacement) const noexcept {
    planar.position += displacement.head<2>();
    planar.yaw += displacement.z() / body_.gyration_radius();
  }

  [[nodiscard]] PlanarState first_guess() const noexcept {
    if (guess_ != nullptr) return *guess_;
    PlanarState guess = state_.planar;
    guess.position += dt_ * state_.planar.twist.head<2>();
    guess.yaw += dt_ * state_.planar.twist.z();
    return guess;
  }

  /// Implicit step: finds the end whose contact forces lead to that same end, by Newton's method.
  /// Its Jacobian neglects the support's friction, which only makes the body stiffer, so that steps
  /// are never too long; Broyden updates add what it lacks.
  void slide() noexcept {
    const FrictionParameters& parameters = body_.physics().friction;
    const double compliance = dt_ / (2.0 * parameters.mass / dt_ + parameters.viscous);
    PlanarState guess = first_guess();
    PlanarFriction friction = friction_;
    friction.static_to_kinetic_ratio = 1.0;  // it has broken loose
    // The Stribeck factor is for the speed at the begin: over a step that brakes a body to its
    // Stribeck speed, friction's fall is steeper than the body's inertia over the step, so that no
    // implicit step is unique.
    const double sliding_force =
        friction_.sliding.force * body_.stribeck_factor(state_.planar.twist);
    const double force_tolerance = kForceTolerance * static_friction_limit(parameters);
    PlanarState best = state_.planar;  // at rest, where no end is finite
    best.twist.setZero();
    Load at_best;
    double min_error = std::numeric_limits<double>::infinity();  // [m] estimated, of the end
    // Correction of the Jacobian by the changes so far [Broyden 1965].
    Eigen::Matrix3d correction = Eigen::Matrix3d::Zero();
    Eigen::Vector3d change = Eigen::Vector3d::Zero();
    bool has_change = false;
    double rough_tolerance = 0.0;  // of the residual, where a rough solution suffices
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const Load load = load_at(guess, contacts_at(guess, tip_.to), end_share_);
      friction.sliding.force = sliding_force * body_.weight_share(load.down());
      const PlanarStep step = body_.step(friction, state_.planar, load.wrench, dt_);
      const Eigen::Vector3d residual = scaled(guess) - scaled(step.state);
      const Eigen::Matrix3d slope = Eigen::Matrix3d::Identity() + compliance * load.stiffness;
      const double error = (slope.inverse() * residual).norm();
      if (error >= min_error) {  // a contact opened or closed: backtrack by half
        correction.setZero();
        has_change = false;
        change *= 0.5;
        move(guess, change);
        continue;
      }
      if (has_change) correction -= residual * change.transpose() / change.squaredNorm();
      min_error = error;
      best = step.state;
      at_best = load;
      residual_ = residual.norm();
      if (iteration == 0) rough_tolerance = relative_tolerance_ * error;
      if (residual_ <= std::max(kDisplacementTolerance, rough_tolerance)) break;
      if (residual_ <= kMaxResidual && (load.stiffness * residual).norm() <= force_tolerance) break;
      change = (slope + correction).inverse() * residual;
      has_change = true;
      move(guess, -change);
    }
    const Load load = load_at(best, contacts_at(best, tip_.to), 1.0);
    finish(best, load, best.twist.isZero(0.0) ? static_load_ratio(load) : 1.0);
  }

  /// `load_ratio`: see static_load_ratio.
  void finish(const PlanarState& planar, const Load& load, double load_ratio) noexcept {
    state_.planar = planar;
    state_.penetration = load.contacts.deepest().depth;
    keep_entry(load.contacts.deepest());
    keep_grips(load);
    state_.tool_force_base = load.tip_force();
    state_.is_saturated = load.tips[0].force.norm() >= kSaturatedShare * body_.max_contact_force();
    const bool is_critical = body_.is_movable() && load_ratio >= body_.critical_share();
    if (planar.twist.isZero(0.0)) {
      state_.planar.phase = is_critical ? FrictionPhase::critical : FrictionPhase::static_contact;
    }
    const double speed = std::max(planar.twist.head<2>().norm(),
                                  std::abs(planar.twist.z()) * body_.gyration_radius());
    if (speed >= (state_.phase == MotionPhase::sliding ? kStoppedSpeed : kSlidingSpeed)) {
      state_.phase = MotionPhase::sliding;
    } else if (state_.tool_force_base.isZero(0.0)) {
      state_.phase = MotionPhase::free;
    } else {
      state_.phase = is_critical ? MotionPhase::critical : MotionPhase::static_contact;
    }
  }

  const UprightBody& body_;
  BodyState state_;
  TipPath tip_;
  std::span<const SideContact> sides_;
  const PlanarState* guess_;
  double relative_tolerance_;
  double dt_;
  TipContacts contacts_;     ///< at the begin
  PlanarFriction friction_;  ///< under the weight alone
  double end_share_ = 0.5;
  double residual_ = 0.0;  ///< see BodyStep
};

}  // namespace

BodyStep step_body(const UprightBody& body, const BodyState& state, const TipPath& tip,
                   std::span<const SideContact> sides, double dt, const PlanarState* guess,
                   double relative_tolerance) noexcept {
  const BodyStep step = BodyStepper(body, state, tip, sides, dt, guess, relative_tolerance).run();
  return is_finite(step.state) ? step : BodyStep{held(state), 0.0};
}

BodyState stop_body(const UprightBody& body, const BodyState& state, const TipPath& tip,
                    double dt) noexcept {
  return BodyStepper(body, state, tip, {}, dt, nullptr, 0.0).stop();
}

}  // namespace pcavr::detail
