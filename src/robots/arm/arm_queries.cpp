// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/arm/arm_queries.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/robot_collision.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;          // [s] of the controller
constexpr int kCollisionInterval = 5;     // cycles: a joint at 3 rad/s turns by 0.015 rad
constexpr double kTimeGrid = 0.02;        // [s] of the search for an arrival
constexpr double kTimeAccuracy = 1e-3;    // [s]
constexpr double kMaxQueriedForce = 1e4;  // [N]

/// Fifth-order polynomial from 0 to 1 with speed and acceleration 0 at both ends.
double smooth_step(double s) { return s * s * s * (10.0 + s * (6.0 * s - 15.0)); }
constexpr double kSmoothStepSpeed = 1.875;  // its greatest slope

/// One arm, simulated again and again.
class Query {
 public:
  Query(const QueriedArm& arm, const ArmQueryOptions& options)
      : arm_(arm),
        options_(options),
        driven_(arm.model, arm.friction, options.drive),
        inverse_(arm.model, arm.tip),
        jacobian_(6, arm.q.size()) {
    PCAVR_REQUIRE(arm.q.size() == static_cast<Eigen::Index>(arm.model.dof));
    driven_.dynamics().forward_kinematics(arm.q);
    orientation_ = driven_.dynamics().T_base_link(arm.tip).rotation();
    if (arm.link_meshes.empty()) return;
    collision_.emplace(arm.model, arm.link_meshes, arm.tip, arm.q);
    for (const TriangleMesh& obstacle : arm.obstacles) collision_->add_surface(obstacle);
  }

  /// Null where the point is out of reach. The same point again costs nothing.
  [[nodiscard]] const Eigen::VectorXd* solve(const Eigen::Vector3d& p) {
    if (!solved_for_ || *solved_for_ != p) {
      solution_ = arm_.q;
      is_reached_ = inverse_.solve(Pose(orientation_, p), solution_).status == IkStatus::kReached;
      solved_for_ = p;
    }
    return is_reached_ ? &solution_ : nullptr;
  }

  void start(const Eigen::VectorXd& q) {
    driven_.reset(q);
    torque_ = {};
    nearest_.reset();
    cycle_ = 0;
  }

  /// One cycle; `force` [N] is the tip's on what it touches.
  void step(const Eigen::VectorXd& q_command, const Eigen::Vector3d& force) {
    driven_.dynamics().jacobian(driven_.q(), arm_.tip, jacobian_);
    const Eigen::VectorXd external = -jacobian_.topRows<3>().transpose() * force;
    driven_.step(q_command, external, kCycle);
    if (driven_.torque_ratio() > torque_.ratio) {
      torque_ = {driven_.torque_ratio(), driven_.loaded_joint()};
    }
    if (cycle_++ % kCollisionInterval == 0) watch();
  }

  [[nodiscard]] Eigen::Vector3d p_tip() {
    driven_.dynamics().forward_kinematics(driven_.q());
    return driven_.dynamics().T_base_link(arm_.tip).translation();
  }
  [[nodiscard]] Eigen::Vector3d v_tip() {
    driven_.dynamics().jacobian(driven_.q(), arm_.tip, jacobian_);
    return jacobian_.topRows<3>() * driven_.dq();
  }

  /// Why the motion since start() could not be done; empty if it could.
  [[nodiscard]] std::string fault() const {
    if (torque_.ratio > 1.0) {
      return "joint " + arm_.model.joints[arm_.model.coordinate_joints()[torque_.joint]].name +
             " would need more torque than it has";
    }
    if (!nearest_) return {};
    const std::string& link = arm_.model.links[nearest_->link].name;
    if (nearest_->other_link) {
      return "link " + link + " would come too close to link " +
             arm_.model.links[*nearest_->other_link].name;
    }
    return "link " + link + " would come too close to the scene";
  }

  [[nodiscard]] bool is_blocked() const { return nearest_.has_value(); }
  [[nodiscard]] const TorqueUse& torque() const { return torque_; }
  [[nodiscard]] InverseKinematics& inverse() { return inverse_; }
  [[nodiscard]] const Eigen::Quaterniond& orientation() const { return orientation_; }
  [[nodiscard]] const Eigen::VectorXd& q() const { return driven_.q(); }

 private:
  /// Notes the first pair that is closer than allowed.
  void watch() {
    if (!collision_ || nearest_) return;
    driven_.dynamics().forward_kinematics(driven_.q());
    collision_->place_links(driven_.dynamics());
    std::optional<NearestPair> found = collision_->distance_to_itself();
    if (!found || found->distance >= options_.clearance) {
      found = collision_->distance_to_surfaces(options_.clearance);
    }
    if (found && found->distance < options_.clearance) nearest_ = found;
  }

  const QueriedArm& arm_;
  ArmQueryOptions options_;
  DrivenArm driven_;
  InverseKinematics inverse_;
  std::optional<RobotCollision> collision_;
  Matrix6Xd jacobian_;
  Eigen::Quaterniond orientation_;
  std::optional<Eigen::Vector3d> solved_for_;
  Eigen::VectorXd solution_;  ///< of `solved_for_`
  bool is_reached_ = false;
  TorqueUse torque_;
  std::optional<NearestPair> nearest_;
  int cycle_ = 0;
};

/// The greatest planned joint speed over its limit, for a motion that takes `time`.
double speed_ratio_of(const RobotModel& model, const Eigen::VectorXd& change, double time) {
  double ratio = 0.0;
  for (const std::size_t i : model.coordinate_joints()) {
    const RobotJoint& joint = model.joints[i];
    if (!joint.limits.velocity) continue;
    const double speed =
        kSmoothStepSpeed * std::abs(change[static_cast<Eigen::Index>(joint.coordinate)]) / time;
    ratio = std::max(ratio, speed / *joint.limits.velocity);
  }
  return ratio;
}

/// Simulates the motion to where the target will be at `time`.
ReachAnswer try_reach(Query& query, const QueriedArm& arm, const Eigen::Vector3d& p_target,
                      double time, const ArmQueryOptions& options) {
  ReachAnswer answer{.time = time, .p_target = p_target};
  const Eigen::VectorXd* const goal = query.solve(p_target);
  if (!goal) {
    answer.reason = "the point is out of reach with the tip's orientation";
    return answer;
  }
  const Eigen::VectorXd change = *goal - arm.q;
  answer.speed_ratio = speed_ratio_of(arm.model, change, time);
  if (answer.speed_ratio > 1.0) {
    answer.reason = "a joint would be faster than its limit";
    return answer;
  }
  query.start(arm.q);
  const long cycles = std::max(1L, std::lround(time / kCycle));
  Eigen::VectorXd command = arm.q;
  for (long i = 1; i <= cycles; ++i) {
    command = arm.q + smooth_step(static_cast<double>(i) / static_cast<double>(cycles)) * change;
    query.step(command, Eigen::Vector3d::Zero());
    if (query.is_blocked()) break;
  }
  answer.torque = query.torque();
  answer.error = (query.p_tip() - p_target).norm();
  answer.reason = query.fault();
  if (answer.reason.empty() && !(*answer.error <= options.position_tolerance)) {
    answer.reason = "the tip is not there yet";
  }
  answer.is_possible = answer.reason.empty();
  return answer;
}

/// The tip's deflection under a force that grows and is then held.
struct HeldForce {
  double deflection = 0.0;
  TorqueUse torque;
  std::string fault;
};
HeldForce hold(Query& query, const Eigen::VectorXd& q, const Eigen::Vector3d& force,
               const ArmQueryOptions& options) {
  query.start(q);
  const Eigen::Vector3d p_start = query.p_tip();
  const double ramp = 0.5 * options.hold_time;
  const long cycles = std::lround((ramp + options.hold_time) / kCycle);
  for (long i = 1; i <= cycles; ++i) {
    const double part = std::min(1.0, static_cast<double>(i) * kCycle / ramp);
    query.step(q, part * force);
  }
  return {(query.p_tip() - p_start).norm(), query.torque(), query.fault()};
}

bool is_held(const HeldForce& held, const ArmQueryOptions& options) {
  return held.fault.empty() && held.deflection <= options.max_deflection;
}

double max_held_force(Query& query, const Eigen::VectorXd& q, const Eigen::Vector3d& direction,
                      const ArmQueryOptions& options) {
  double low = 0.0;
  double high = 1.0;
  while (high < kMaxQueriedForce && is_held(hold(query, q, high * direction, options), options)) {
    low = std::exchange(high, 2.0 * high);
  }
  constexpr double kAccuracy = 0.01;  // relative
  while (high - low > kAccuracy * high) {
    const double middle = 0.5 * (low + high);
    (is_held(hold(query, q, middle * direction, options), options) ? low : high) = middle;
  }
  return low;
}

}  // namespace

ReachAnswer can_reach(const QueriedArm& arm, const std::function<Eigen::Vector3d(double)>& p_target,
                      std::optional<double> time, const ArmQueryOptions& options) {
  PCAVR_REQUIRE(!time || *time > 0.0);
  Query query(arm, options);
  const auto at = [&](double t) { return try_reach(query, arm, p_target(t), t, options); };
  const bool is_still = p_target(0.0) == p_target(options.max_time);
  // A still point that slow motion does not reach is not reached by fast motion either.
  const bool is_searched = !is_still || at(options.max_time).is_possible;
  std::optional<ReachAnswer> earliest;
  double last = kTimeGrid;
  for (long i = 1; is_searched && kTimeGrid * static_cast<double>(i) <= options.max_time; ++i) {
    last = kTimeGrid * static_cast<double>(i);
    ReachAnswer found = at(last);
    if (!found.is_possible) continue;
    earliest = std::move(found);
    break;
  }
  if (earliest) {
    double too_early = last - kTimeGrid;
    while (earliest->time - too_early > kTimeAccuracy) {
      const double middle = 0.5 * (too_early + earliest->time);
      ReachAnswer found = at(middle);
      if (found.is_possible) {
        earliest = std::move(found);
      } else {
        too_early = middle;
      }
    }
  }
  ReachAnswer answer = time ? at(*time) : earliest ? *earliest : at(options.max_time);
  if (earliest) answer.min_time = earliest->time;
  return answer;
}

HoldAnswer can_hold(const QueriedArm& arm, const Eigen::Vector3d& p_tip,
                    const Eigen::Vector3d& force, const ArmQueryOptions& options) {
  PCAVR_REQUIRE(force.allFinite() && force.norm() > 0.0);
  Query query(arm, options);
  HoldAnswer answer;
  const Eigen::VectorXd* const q = query.solve(p_tip);
  if (!q) {
    answer.reason = "the point is out of reach with the tip's orientation";
    return answer;
  }
  const HeldForce held = hold(query, *q, force, options);
  answer.deflection = held.deflection;
  answer.torque = held.torque;
  answer.reason = held.fault;
  if (answer.reason.empty() && held.deflection > options.max_deflection) {
    answer.reason = "the tip would give way further than allowed";
  }
  answer.is_possible = answer.reason.empty();
  answer.max_force = max_held_force(query, *q, force.normalized(), options);
  return answer;
}

ReleaseSpeed release_speed(const FrictionParameters& body, double distance) {
  PCAVR_REQUIRE(is_physical(body) && distance >= 0.0, distance);
  const auto slide = [&](double speed) {
    SliderState state{.velocity = speed, .phase = FrictionPhase::sliding};
    double time = 0.0;
    constexpr double kStep = 0.05;      // [s]: steps are solved in closed form
    constexpr double kLongest = 600.0;  // [s]
    while (state.velocity > 0.0 && time < kLongest) {
      const SliderStep step = step_slider(body, state, {}, kStep);
      time += step.moving_time;
      state = step.state;
    }
    return std::pair(state.position, time);
  };
  double low = 0.0;
  double high = 0.01;
  constexpr double kMaxSpeed = 100.0;  // [m/s]
  while (slide(high).first < distance && high < kMaxSpeed) low = std::exchange(high, 2.0 * high);
  constexpr double kAccuracy = 1e-6;  // relative
  while (high - low > kAccuracy * high) {
    const double middle = 0.5 * (low + high);
    (slide(middle).first < distance ? low : high) = middle;
  }
  return {high, slide(high).second};
}

PushAnswer can_push(const QueriedArm& arm, const FrictionParameters& body, double distance,
                    const Eigen::Vector3d& p_tip, const Eigen::Vector3d& direction,
                    const ArmQueryOptions& options) {
  PCAVR_REQUIRE(direction.norm() > 0.0);
  const ReleaseSpeed release = release_speed(body, distance);
  const Eigen::Vector3d along = direction.normalized();
  const double acceleration = release.speed * release.speed / (2.0 * options.run_up);
  PushAnswer answer{.speed = release.speed, .sliding_time = release.sliding_time};
  answer.force =
      std::max(static_friction_limit(body),
               body.mass * acceleration + body.coulomb_force + body.viscous * release.speed);
  Query query(arm, options);
  const Eigen::VectorXd* const start = query.solve(p_tip);
  if (!start) {
    answer.reason = "the point is out of reach with the tip's orientation";
    return answer;
  }
  query.start(*start);
  Eigen::VectorXd command = *start;
  const double duration = 2.0 * options.run_up / release.speed;
  const long cycles = std::max(1L, std::lround(duration / kCycle));
  double greatest_error = 0.0;
  for (long i = 1; i <= cycles; ++i) {
    const double t = static_cast<double>(i) * kCycle;
    const Eigen::Vector3d p = p_tip + 0.5 * acceleration * t * t * along;
    const IkResult found = query.inverse().follow(Pose(query.orientation(), p), kCycle, command);
    greatest_error = std::max(greatest_error, found.position_error);
    const double resistance = body.mass * acceleration + body.coulomb_force +
                              body.viscous * std::max(0.0, query.v_tip().dot(along));
    query.step(command, resistance * along);
    answer.reached_speed = std::max(answer.reached_speed, query.v_tip().dot(along));
  }
  answer.torque = query.torque();
  answer.reason = query.fault();
  constexpr double kSpeedTolerance = 0.05;  // relative
  if (answer.reason.empty() && greatest_error > options.max_deflection) {
    answer.reason = "the push leaves the arm's reach, or a joint would be too fast";
  }
  if (answer.reason.empty() && answer.reached_speed < (1.0 - kSpeedTolerance) * answer.speed) {
    answer.reason = "the tip does not reach the speed";
  }
  answer.is_possible = answer.reason.empty();
  return answer;
}

}  // namespace pcavr
