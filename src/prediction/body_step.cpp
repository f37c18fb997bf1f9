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

/// A step is solved where the contacts' forces and the motion that they cause agree to this share
/// of F_M, far below what a force sensor tells; or the motion to this [m]. Forces tell nothing of
/// contacts that the motion is yet to close: so it has to agree to a little, in any case.
constexpr double kSolvedForce = 3e-4;
constexpr double kSolvedWay = 1e-10;
constexpr double kNearlySolved = 1e-6;
constexpr int kMaxRounds = 24;
/// Of a step: less is left for the next one.
constexpr double kMinShareOfStep = 1e-3;
/// Normals that rise less than this (sine) can push a body out sideways.
constexpr double kSteepest = 0.87;
/// Of the contact's swing, in radians, that a step may take at once; the parts that this makes of a
/// step; and a clearance [m] within which a turning body may touch.
constexpr double kMaxPart = 0.5;
constexpr double kMaxStepParts = 16.0;
constexpr double kNear = 1e-3;
/// phases.csv: sliding from the one speed on until slower than the other [m/s].
constexpr double kSlides = 1e-3;
constexpr double kStops = 0.3e-3;

/// All but the support's friction that acts on the body in one configuration.
struct Load {
  Touch touch;
  TipForce tip;
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  /// How the wrench falls as the body moves, in the axes x, y and gyration radius times yaw.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();

  [[nodiscard]] double down() const { return -tip.force.z(); }
};

/// How the body came to be where it is.
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
              double share) noexcept
      : body_(body),
        state_(state),
        tip_(tip),
        sides_(sides),
        guess_(guess),
        enough_share_(share),
        dt_(dt) {
    if ((tip.to - tip.from).norm() > kFastestTip * dt) tip_.from = tip.to;
    touch_ = touch_at(state.planar, tip_.from);
    settle();
    // By the force at the begin: over a step it hardly changes, and in a round of the search for
    // the end it would cost as much as the rest.
    friction_ =
        body.friction_under(state_.tool_force_base, touch_.arm, touch_.height, state_.planar.yaw);
    // How much of the step's end counts in the contact's mean depth: the middle, which is of second
    // order, for contacts that the step resolves; nearly the end for those that it does not, so
    // that they don't ring.
    const double swing = dt * dt * body.working_stiffness() / body.physics().friction.mass;
    end_share_ = 0.5 + 0.5 * swing / (4.0 + swing);
  }

  BodyStep run() noexcept {
    if (state_.planar.twist.isZero(0.0)) {
      hold();
    } else {
      slide();
    }
    return {state_, gap_};
  }

 private:
  [[nodiscard]] Touch touch_at(const PlanarState& planar,
                               const Eigen::Vector3d& tip) const noexcept {
    return touch_of(body_, planar, tip, tip_.radius).value_or(Touch{});
  }

  /// A pose or a tip that was set from outside may lie deeper than any force allows: then the body
  /// is where a slow push would have brought it.
  void settle() noexcept {
    if (!(touch_.depth > 0.0)) return;
    const double allowed = std::max(state_.penetration, body_.holding_depth());
    if (!(touch_.depth > allowed + 1e-8)) return;
    for (int i = 0; i < 8; ++i) {  // more than one only where the surface is bent
      if (std::abs(touch_.normal.z()) > kSteepest) break;
      const double excess = touch_.depth - body_.sliding_depth();
      const Eigen::Vector2d flat = touch_.normal.head<2>();
      if (excess < 1e-7) break;
      state_.planar.position -= excess / flat.squaredNorm() * flat;
      touch_ = touch_at(state_.planar, tip_.from);
    }
    state_.planar.twist.setZero();
    state_.tool_stretch_base.setZero();
  }

  void add_sides(const Displacement& own, double share, Load& load) const noexcept {
    for (const SideContact& side : sides_) {
      const Eigen::Vector2d slip = share * side.neighbour_way - own.at(side.arm);
      const SideForce answer = side_force(side, slip, share * dt_);
      if (answer.force.isZero(0.0)) continue;
      load.wrench += wrench_at(side.arm, {answer.force.x(), answer.force.y(), 0.0});
      load.stiffness += carried(answer.stiffness, side.arm);
    }
  }

  /// A stiffness at a point, as the body's motion feels it.
  [[nodiscard]] Eigen::Matrix3d carried(const Eigen::Matrix2d& stiffness,
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

  /// With the body still, and tip and neighbours a share of their way along.
  [[nodiscard]] Load load_at_rest(double share) const noexcept {
    Load load;
    const Eigen::Vector3d way = share * (tip_.to - tip_.from);
    load.touch = touch_at(state_.planar, tip_.from + way);
    const double time = share * dt_;
    const double rate = time > 0.0 ? (load.touch.depth - touch_.depth) / time : 0.0;
    Eigen::Vector3d stretch = Eigen::Vector3d::Zero();
    if (touch_.depth > 0.0) stretch = state_.tool_stretch_base + way;
    load.tip = tip_force(body_.physics(), load.touch.normal, load.touch.depth, rate, stretch,
                         (tip_.to - tip_.from) / dt_);
    load.wrench = wrench_at(load.touch.arm, load.tip.force);
    if (time > 0.0) add_sides({}, share, load);
    return load;
  }

  /// Of the load over what the support holds.
  [[nodiscard]] double holding_share(const Load& load) const noexcept {
    if (load.wrench.isZero(0.0)) return 0.0;
    return body_.level_of(friction_, state_.planar.yaw, load.wrench) /
           (body_.weight_share(load.down()) * std::max(friction_.holding, 1.0));
  }

  void hold() noexcept {
    const Load load = load_at_rest(1.0);
    const double share = holding_share(load);
    if (share > 1.0 && break_loose(share)) return;
    conclude(state_.planar, load, share);
  }

  /// Finds when the load passes the limit, and slides from there. False where too little is left.
  bool break_loose(double share_at_end) noexcept {
    double low = 0.0;
    double high = 1.0;
    double low_excess = holding_share(load_at_rest(low)) - 1.0;
    double high_excess = share_at_end - 1.0;
    // Neighbours' contacts are not cut at an instant: their loads come within a few steps anyway.
    if (low_excess > 0.0 || !sides_.empty()) high = 0.0;
    for (int i = 0; i < 6 && high - low > kMinShareOfStep; ++i) {  // Illinois
      const double at = low + (high - low) * low_excess / (low_excess - high_excess);
      const double excess = holding_share(load_at_rest(at)) - 1.0;
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
      state_.tool_stretch_base = load.tip.stretch;
      touch_ = load.touch;
      tip_.from += high * (tip_.to - tip_.from);
      dt_ *= 1.0 - high;
    }
    slide();
    return true;
  }

  /// With the body's end at `planar`; `end_share` 1 for the load there, less for its mean.
  [[nodiscard]] Load load_at(const PlanarState& planar, const Touch& touch,
                             double end_share) const noexcept {
    Load load;
    load.touch = touch;
    const Displacement own{planar.position - state_.planar.position,
                           planar.yaw - state_.planar.yaw};
    if (touch.depth > 0.0 || touch_.depth > 0.0) {
      const double begin = std::max(touch_.depth, 0.0);
      const double end = end_share < 1.0 ? std::max(touch.depth, 0.0) : touch.depth;
      Eigen::Vector3d slip = tip_.to - tip_.from;
      slip.head<2>() -= own.at(touch.arm);
      Eigen::Vector3d stretch = end_share * slip;
      if (touch_.depth > 0.0) stretch += state_.tool_stretch_base;
      load.tip = tip_force(body_.physics(), touch.normal, begin + end_share * (end - begin),
                           (touch.depth - touch_.depth) / dt_, stretch, slip / dt_);
      load.wrench = wrench_at(touch.arm, load.tip.force);
      load.stiffness = carried(flat_stiffness(load.tip, touch.normal.head<2>()), touch.arm);
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

  void move(PlanarState& planar, const Eigen::Vector3d& way) const noexcept {
    planar.position += way.head<2>();
    planar.yaw += way.z() / body_.gyration_radius();
  }

  [[nodiscard]] PlanarState first_guess() const noexcept {
    if (guess_ != nullptr) return *guess_;
    PlanarState guess = state_.planar;
    guess.position += dt_ * state_.planar.twist.head<2>();
    guess.yaw += dt_ * state_.planar.twist.z();
    return guess;
  }

  /// Newton's method on: the end that the contacts' forces lead to is the end that causes them. Its
  /// slope takes the body for free, which its friction only stiffens: so it errs to the safe side,
  /// and learns the rest on the way.
  void slide() noexcept {
    const FrictionParameters& parameters = body_.physics().friction;
    const double compliance = dt_ / (2.0 * parameters.mass / dt_ + parameters.viscous);
    PlanarState guess = first_guess();
    PlanarFriction friction = friction_;
    friction.holding = 1.0;  // it has broken loose
    const double enough = kSolvedForce * holding_force(parameters);
    PlanarState best;
    Load at_best;
    double least = std::numeric_limits<double>::infinity();  // [m] from the solution, as it seems
    // What the slope lacks, as the changes so far showed it [Broyden 1965].
    Eigen::Matrix3d lacking = Eigen::Matrix3d::Zero();
    Eigen::Vector3d change = Eigen::Vector3d::Zero();
    bool learns = false;
    double bettered = 0.0;  // a residual that is enough for now
    for (int round = 0; round < kMaxRounds; ++round) {
      const Load load = load_at(guess, touch_at(guess, tip_.to), end_share_);
      friction.sliding.force = friction_.sliding.force * body_.weight_share(load.down());
      const PlanarStep step = body_.step(friction, state_.planar, load.wrench, dt_);
      const Eigen::Vector3d residual = scaled(guess) - scaled(step.state);
      const Eigen::Matrix3d slope = Eigen::Matrix3d::Identity() + compliance * load.stiffness;
      const double away = (slope.inverse() * residual).norm();
      if (away >= least) {  // a contact came or went on the way: half of it back
        lacking.setZero();
        learns = false;
        change *= 0.5;
        move(guess, change);
        continue;
      }
      if (learns) lacking -= residual * change.transpose() / change.squaredNorm();
      least = away;
      best = step.state;
      at_best = load;
      gap_ = residual.norm();
      if (round == 0) bettered = enough_share_ * away;
      if (gap_ <= std::max(kSolvedWay, bettered)) break;
      if (gap_ <= kNearlySolved && (load.stiffness * residual).norm() <= enough) break;
      change = (slope + lacking).inverse() * residual;
      learns = true;
      move(guess, -change);
    }
    const Touch touch = touch_at(best, tip_.to);
    const Load load = load_at(best, touch, 1.0);
    conclude(best, load, best.twist.isZero(0.0) ? holding_share(load) : 1.0);
  }

  /// `share`: of what the support would hold.
  void conclude(const PlanarState& planar, const Load& load, double share) noexcept {
    state_.planar = planar;
    state_.penetration = load.touch.depth;
    state_.tool_stretch_base = load.tip.stretch;
    state_.tool_force_base = load.tip.force;
    const bool is_critical = share >= body_.critical_share();
    if (planar.twist.isZero(0.0)) {
      state_.planar.phase = is_critical ? FrictionPhase::critical : FrictionPhase::held;
    }
    const double speed = std::max(planar.twist.head<2>().norm(),
                                  std::abs(planar.twist.z()) * body_.gyration_radius());
    if (speed >= (state_.phase == MotionPhase::sliding ? kStops : kSlides)) {
      state_.phase = MotionPhase::sliding;
    } else if (load.tip.force.isZero(0.0)) {
      state_.phase = MotionPhase::free;
    } else {
      state_.phase = is_critical ? MotionPhase::critical : MotionPhase::held;
    }
  }

  const UprightBody& body_;
  BodyState state_;
  TipPath tip_;
  std::span<const SideContact> sides_;
  const PlanarState* guess_;
  double enough_share_;
  double dt_;
  Touch touch_;              ///< at the begin
  PlanarFriction friction_;  ///< under the weight alone
  double end_share_ = 0.5;
  double gap_ = 0.0;  ///< see BodyStep
};

}  // namespace

int parts_of_step(const UprightBody& body, const BodyState& state, const TipPath& tip,
                  double dt) noexcept {
  const double frequency =
      std::sqrt(body.working_stiffness() / body.physics().friction.mass);  // [rad/s]
  const double parts = std::ceil(frequency * dt / kMaxPart);
  if (!(parts > 1.0)) return 1;
  const double travel =
      (tip.to - tip.from).norm() + dt * state.planar.twist.head<2>().norm() + kNear;
  if (state.penetration < -travel) return 1;
  return static_cast<int>(std::min(parts, kMaxStepParts));
}

BodyStep step_body(const UprightBody& body, const BodyState& state, const TipPath& tip,
                   std::span<const SideContact> sides, double dt, const PlanarState* guess,
                   double enough_share) noexcept {
  return BodyStepper(body, state, tip, sides, dt, guess, enough_share).run();
}

}  // namespace pcavr::detail
