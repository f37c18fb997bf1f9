// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "prediction/body_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "prediction/contact_force.hpp"

namespace pcavr::detail {
namespace {

/// Where the contact's force and the body's motion agree to this [m], a step is solved: 1 mN at
/// 1 MN/m.
constexpr double kSolved = 1e-9;
constexpr int kMostRounds = 24;
/// Of a step: less is left for the next one.
constexpr double kLeastShareOfStep = 1e-3;
/// A tip that is faster [m/s] was put elsewhere: no arm that is guided by hand moves so.
constexpr double kFastestTip = 5.0;
/// Normals that rise less than this (sine) can push a body out sideways.
constexpr double kSteepest = 0.87;
/// Of the contact's swing, in radians, that a step may take at once; the parts that this makes of a
/// step; and a clearance [m] within which a turning body may touch.
constexpr double kLongestPart = 0.5;
constexpr double kMostParts = 16.0;
constexpr double kNear = 1e-3;
/// phases.csv: sliding from the one speed on until slower than the other [m/s].
constexpr double kSlides = 1e-3;
constexpr double kStops = 0.3e-3;

class BodyStepper {
 public:
  BodyStepper(const UprightBody& body, const BodyState& state, const TipPath& tip,
              double dt) noexcept
      : body_(body), state_(state), tip_(tip), dt_(dt) {
    if ((tip.to - tip.from).norm() > kFastestTip * dt) tip_.from = tip.to;
    touch_ = touch_at(state.planar, tip_.from);
    settle();
    // How much of the step's end counts in the contact's mean depth: the middle, which is of second
    // order, for contacts that the step resolves; nearly the end for those that it does not, so
    // that they don't ring.
    const double turned = dt * dt * body.working_stiffness() / body.physics().friction.mass;
    end_share_ = 0.5 + 0.5 * turned / (4.0 + turned);
  }

  BodyState run() noexcept {
    if (state_.planar.twist.isZero(0.0)) {
      hold();
    } else {
      slide();
    }
    return state_;
  }

 private:
  [[nodiscard]] Touch touch_at(const PlanarState& planar,
                               const Eigen::Vector3d& tip) const noexcept {
    return touch_of(body_, planar, tip, tip_.radius).value_or(Touch{});
  }

  /// A pose or a tip that was set from outside may lie deeper than any force allows: then the body
  /// is where a slow push would have brought it.
  void settle() noexcept {
    const double holding = holding_force(body_.physics().friction);
    const double allowed = std::max(state_.penetration, depth_at(body_.physics().contact, holding));
    if (!(touch_.depth > allowed + 1e-9)) return;
    for (int i = 0; i < 8; ++i) {  // more than one only where the surface is bent
      if (std::abs(touch_.normal.z()) > kSteepest) break;
      const double excess = touch_.depth - body_.working_depth();
      const Eigen::Vector2d flat = touch_.normal.head<2>();
      if (excess < 1e-7) break;
      state_.planar.position -= excess / flat.squaredNorm() * flat;
      touch_ = touch_at(state_.planar, tip_.from);
    }
    state_.planar.twist.setZero();
    state_.tool_stretch_base.setZero();
  }

  /// With the body still and the tip a share of its way along.
  [[nodiscard]] TipForce force_at_rest(double share, Touch& touch) const noexcept {
    const Eigen::Vector3d way = share * (tip_.to - tip_.from);
    touch = touch_at(state_.planar, tip_.from + way);
    const double time = share * dt_;
    const double rate = time > 0.0 ? (touch.depth - touch_.depth) / time : 0.0;
    const Eigen::Vector3d stretch = touch_.depth > 0.0
                                        ? Eigen::Vector3d(state_.tool_stretch_base + way)
                                        : Eigen::Vector3d::Zero();
    return tip_force(body_.physics(), touch.normal, touch.depth, rate, stretch,
                     (tip_.to - tip_.from) / dt_);
  }

  /// Of the load over what the support holds.
  [[nodiscard]] double holding_share(const TipForce& tip, const Touch& touch) const noexcept {
    const PlanarFriction friction = body_.friction_under(-tip.force.z());
    return body_.level_of(friction, state_.planar.yaw, wrench_at(touch.arm, tip.force)) /
           std::max(friction.holding, 1.0);
  }

  void hold() noexcept {
    Touch touch;
    const TipForce tip = force_at_rest(1.0, touch);
    const double share = tip.force.isZero(0.0) ? 0.0 : holding_share(tip, touch);
    if (share > 1.0 && break_loose(share)) return;
    conclude(state_.planar, touch, tip, share);
  }

  /// Finds when the load passes the limit, and slides from there. False where too little is left.
  bool break_loose(double share_at_end) noexcept {
    Touch touch;
    double low = 0.0;
    double high = 1.0;
    double low_excess = holding_share_at(low, touch) - 1.0;
    double high_excess = share_at_end - 1.0;
    if (low_excess > 0.0) high = 0.0;
    for (int i = 0; i < 6 && high - low > kLeastShareOfStep; ++i) {  // Illinois
      const double at = low + (high - low) * low_excess / (low_excess - high_excess);
      const double excess = holding_share_at(at, touch) - 1.0;
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
    if (1.0 - high < kLeastShareOfStep) return false;
    if (high > 0.0) {
      state_.tool_stretch_base = force_at_rest(high, touch).stretch;
      touch_ = touch;
      tip_.from += high * (tip_.to - tip_.from);
      dt_ *= 1.0 - high;
    }
    slide();
    return true;
  }

  [[nodiscard]] double holding_share_at(double share, Touch& touch) const noexcept {
    const TipForce tip = force_at_rest(share, touch);
    return tip.force.isZero(0.0) ? 0.0 : holding_share(tip, touch);
  }

  /// The tip's force with the body's end at `planar`: `end_share` 1 for its end, less for the mean.
  [[nodiscard]] TipForce force_at(const PlanarState& planar, const Touch& touch,
                                  double end_share) const noexcept {
    const double begin = std::max(touch_.depth, 0.0);
    const double end = end_share < 1.0 ? std::max(touch.depth, 0.0) : touch.depth;
    const double depth = begin + end_share * (end - begin);
    const Eigen::Vector2d moved = planar.position - state_.planar.position;
    const double turned = planar.yaw - state_.planar.yaw;
    Eigen::Vector3d slip = tip_.to - tip_.from;
    slip.x() -= moved.x() - turned * touch.arm.y();
    slip.y() -= moved.y() + turned * touch.arm.x();
    const Eigen::Vector3d stretch = touch_.depth > 0.0 ? state_.tool_stretch_base + end_share * slip
                                                       : Eigen::Vector3d(end_share * slip);
    return tip_force(body_.physics(), touch.normal, depth, (touch.depth - touch_.depth) / dt_,
                     stretch, slip / dt_);
  }

  /// How the tip's wrench falls as the body moves, in the axes x, y and gyration radius times yaw.
  [[nodiscard]] Eigen::Matrix3d stiffness_of(const TipForce& tip,
                                             const Touch& touch) const noexcept {
    const double along = end_share_ * tip.normal_stiffness + tip.normal_damping / dt_;
    const double across = end_share_ * tip.tangential_stiffness + tip.tangential_damping / dt_;
    const Eigen::Vector2d n = touch.normal.head<2>();
    const Eigen::Matrix2d flat =
        across * Eigen::Matrix2d::Identity() + (along - across) * n * n.transpose();
    const double radius = body_.gyration_radius();
    Eigen::Matrix<double, 2, 3> motion;
    motion << 1.0, 0.0, -touch.arm.y() / radius, 0.0, 1.0, touch.arm.x() / radius;
    return motion.transpose() * flat * motion;
  }

  [[nodiscard]] Eigen::Vector3d scaled(const PlanarState& planar) const noexcept {
    return {planar.position.x(), planar.position.y(), body_.gyration_radius() * planar.yaw};
  }

  void slide() noexcept {
    const FrictionParameters& parameters = body_.physics().friction;
    // How far a constant load moves the body in the step when friction does not turn against it.
    const double compliance = dt_ / (2.0 * parameters.mass / dt_ + parameters.viscous);
    PlanarState guess = state_.planar;
    guess.position += dt_ * state_.planar.twist.head<2>();
    guess.yaw += dt_ * state_.planar.twist.z();
    PlanarState best;
    double best_residual = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kMostRounds && best_residual > kSolved; ++round) {
      const Touch touch = touch_at(guess, tip_.to);
      const TipForce tip = force_at(guess, touch, end_share_);
      PlanarFriction friction = body_.friction_under(-tip.force.z());
      friction.holding = 1.0;  // it has broken loose
      const PlanarStep step =
          body_.step(friction, state_.planar, wrench_at(touch.arm, tip.force), dt_);
      const Eigen::Vector3d residual = scaled(guess) - scaled(step.state);
      if (residual.norm() < best_residual) {
        best_residual = residual.norm();
        best = step.state;
      }
      Eigen::Matrix3d slope = compliance * stiffness_of(tip, touch);
      slope.diagonal().array() += 1.0;
      const Eigen::Vector3d change = slope.inverse() * residual;
      guess.position -= change.head<2>();
      guess.yaw -= change.z() / body_.gyration_radius();
    }
    const Touch touch = touch_at(best, tip_.to);
    const TipForce tip = force_at(best, touch, 1.0);
    const PlanarFriction friction = body_.friction_under(-tip.force.z());
    const double level = body_.level_of(friction, best.yaw, wrench_at(touch.arm, tip.force));
    conclude(best, touch, tip, level / std::max(friction.holding, 1.0));
  }

  /// `holding_share`: of what the support would hold.
  void conclude(const PlanarState& planar, const Touch& touch, const TipForce& tip,
                double share) noexcept {
    state_.planar = planar;
    state_.penetration = touch.depth;
    state_.tool_stretch_base = tip.stretch;
    state_.tool_force_base = tip.force;
    const double speed = std::max(planar.twist.head<2>().norm(),
                                  std::abs(planar.twist.z()) * body_.gyration_radius());
    const bool is_slow = speed < (state_.phase == MotionPhase::sliding ? kStops : kSlides);
    const PlanarFriction friction = body_.friction_under(0.0);
    const bool is_critical = !planar.twist.isZero(0.0) ||
                             share >= 1.0 - friction.holding_std / std::max(friction.holding, 1.0);
    if (planar.twist.isZero(0.0)) {
      state_.planar.phase = is_critical ? FrictionPhase::critical : FrictionPhase::held;
    }
    if (!is_slow) {
      state_.phase = MotionPhase::sliding;
    } else if (tip.force.isZero(0.0)) {
      state_.phase = MotionPhase::free;
    } else {
      state_.phase = is_critical ? MotionPhase::critical : MotionPhase::held;
    }
  }

  const UprightBody& body_;
  BodyState state_;
  TipPath tip_;
  double dt_;
  Touch touch_;  ///< at the begin
  double end_share_ = 0.5;
};

/// A stiff contact swings faster than a step can follow; an impact is over within it.
int parts_of_step(const UprightBody& body, const BodyState& state, const TipPath& tip,
                  double dt) noexcept {
  const double frequency =
      std::sqrt(body.working_stiffness() / body.physics().friction.mass);  // [rad/s]
  const double parts = std::ceil(frequency * dt / kLongestPart);
  if (!(parts > 1.0)) return 1;
  const double travel =
      (tip.to - tip.from).norm() + dt * state.planar.twist.head<2>().norm() + kNear;
  if (state.penetration < -travel) return 1;
  return static_cast<int>(std::min(parts, kMostParts));
}

}  // namespace

BodyState step_body(const UprightBody& body, const BodyState& state, const TipPath& tip,
                    double dt) noexcept {
  const int parts = parts_of_step(body, state, tip, dt);
  if (parts == 1) return BodyStepper(body, state, tip, dt).run();
  BodyState moved = state;
  TipPath part = tip;
  for (int i = 1; i <= parts; ++i) {
    part.to = tip.from + (static_cast<double>(i) / parts) * (tip.to - tip.from);
    moved = BodyStepper(body, moved, part, dt / parts).run();
    part.from = part.to;
  }
  return moved;
}

}  // namespace pcavr::detail
