// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/motion_limiter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/options.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {
namespace {

constexpr auto kLimitFields = std::to_array<OptionField<MotionLimits>>({
    {"max_speed", &MotionLimits::max_speed, 0.5, 1e-3, 10.0, "m/s",
     "maximum speed of the tool, along each axis",
     "lower: the tool lags behind a hand; higher: impacts with more energy"},
    {"max_acceleration", &MotionLimits::max_acceleration, 5.0, 0.01, 200.0, "m/s^2",
     "maximum acceleration of the tool, along each axis; a hold ends within speed / acceleration",
     "lower: the tool overshoots a hand that stops; higher: jerks of the arm"},
    {"max_step", &MotionLimits::max_step, 0.02, 1e-4, 1.0, "m",
     "maximum distance of the command ahead of the tool, along each axis",
     "lower: fast motion is cut; higher: a jump of the command becomes a long motion"},
    {"max_overshoot", &MotionLimits::max_overshoot, 0.001, 0.0, 0.1, "m",
     "by which the tool may pass a command that stops at once, along each axis; the default lets "
     "it follow a push of 0.1 m/s without a lag",
     "lower: the tool lags behind a hand that moves steadily; higher: it presses deeper at a stop"},
    {"max_force", &MotionLimits::max_force, 60.0, 0.1, 1e4, "N",
     "force above which the tool does not press on",
     "lower: heavy objects can't be pushed; higher: damage of tool or object"},
    {"min_x", &MotionLimits::min_x, -2.0, -1e4, 1e4, "m", "workspace, lower end of x",
     "narrower: the tool stops short of its task; wider: it reaches what surrounds it"},
    {"max_x", &MotionLimits::max_x, 2.0, -1e4, 1e4, "m", "workspace, upper end of x",
     "narrower: the tool stops short of its task; wider: it reaches what surrounds it"},
    {"min_y", &MotionLimits::min_y, -2.0, -1e4, 1e4, "m", "workspace, lower end of y",
     "narrower: the tool stops short of its task; wider: it reaches what surrounds it"},
    {"max_y", &MotionLimits::max_y, 2.0, -1e4, 1e4, "m", "workspace, upper end of y",
     "narrower: the tool stops short of its task; wider: it reaches what surrounds it"},
    {"min_z", &MotionLimits::min_z, -1.0, -1e4, 1e4, "m", "workspace, lower end of z",
     "narrower: the tool stops short of its task; wider: it reaches what surrounds it"},
    {"max_z", &MotionLimits::max_z, 3.0, -1e4, 1e4, "m", "workspace, upper end of z",
     "narrower: the tool stops short of its task; wider: it reaches what surrounds it"},
});
static_assert(are_valid_fields(kLimitFields));

std::optional<Error> check_workspace(const MotionLimits& limits) {
  if ((limits.workspace_min().array() < limits.workspace_max().array()).all()) return std::nullopt;
  return Error{.message = "the workspace is empty",
               .place = "robot_site.limits",
               .hint = "each min must be below its max"};
}

/// Highest speed v from which the tool, slowing down by `acceleration` from the next cycle on,
/// stops within `distance` [m]. With m = floor(v / (a dt)) it still moves by dt (v + (v - a dt) +
/// ... + (v - m a dt)); the continuous formula lets it reach a wall with up to an eighth of a dt
/// too much.
double braking_speed(double distance, double acceleration, double dt) {
  const double unit = acceleration * dt * dt;
  const double d = std::max(distance, 0.0) / unit;
  const double cycles = std::floor(0.5 * (std::sqrt(1.0 + 8.0 * d) - 1.0));
  return (d / (cycles + 1.0) + 0.5 * cycles) * acceleration * dt;
}

/// The velocity without its parts that press on, axis by axis, against a force [N, base frame] that
/// is too high. Not only its part along the force: friction turns this with each change of
/// direction, and a wall takes what would have lifted the tool off, so that it would creep on.
Eigen::Vector3d without_pressing(const Eigen::Vector3d& v_base, const Eigen::Vector3d& force_base) {
  if (!force_base.allFinite()) return Eigen::Vector3d::Zero();
  return (v_base.array() * force_base.array() > 0.0).select(0.0, v_base);
}

}  // namespace

MotionLimits::MotionLimits() { set_defaults(*this, kLimitFields); }
OptionSection section_of(MotionLimits& options) {
  OptionSection section = make_section("robot_site.limits", options, kLimitFields);
  section.check = [&options] { return check_workspace(options); };
  return section;
}

MotionLimiter::MotionLimiter(const MotionLimits& limits, const Eigen::Vector3d& p_base_tip)
    : limits_(limits),
      p_base_(p_base_tip.cwiseMax(limits.workspace_min()).cwiseMin(limits.workspace_max())) {
  PCAVR_REQUIRE(limits.max_speed > 0.0 && limits.max_acceleration > 0.0, limits.max_speed,
                limits.max_acceleration);
  PCAVR_REQUIRE(limits.max_step > 0.0 && limits.max_force > 0.0, limits.max_step, limits.max_force);
  PCAVR_REQUIRE(!check_workspace(limits));
}

/// The target's own, as far as the tool may overshoot it, and besides that what brings the tool to
/// it such that it can brake.
Eigen::Vector3d MotionLimiter::velocity_to(const Eigen::Vector3d& p_base, double dt) {
  const auto brake = [&](double distance) {
    return braking_speed(std::abs(distance), limits_.max_acceleration, dt);
  };
  const double steady = brake(limits_.max_overshoot);
  const Eigen::Vector3d v_target = (p_base - last_target_.value_or(p_base)) / dt;
  Eigen::Vector3d wanted;
  for (int axis = 0; axis < 3; ++axis) {
    const double ahead =
        std::clamp(p_base[axis] - p_base_[axis], -limits_.max_step, limits_.max_step);
    if (ahead != p_base[axis] - p_base_[axis]) note(LinkLimit::step);
    const double v_steady = std::clamp(v_target[axis], -steady, steady);
    const double behind = ahead - v_steady * dt;
    const double gain = std::min(std::abs(behind) / dt, brake(behind));
    const double fastest =
        brake(std::min(std::abs(ahead) + limits_.max_overshoot, limits_.max_step));
    const double v = std::clamp(v_steady + std::copysign(gain, behind), -fastest, fastest);
    if (std::abs(v) > limits_.max_speed) note(LinkLimit::speed);
    wanted[axis] = std::clamp(v, -limits_.max_speed, limits_.max_speed);
  }
  return wanted;
}

const Eigen::Vector3d& MotionLimiter::step(const std::optional<Eigen::Vector3d>& command,
                                           const Eigen::Vector3d& force_base, double dt) {
  active_ = 0;
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();  // velocity
  if (command && command->allFinite()) {
    Eigen::Vector3d target =
        command->cwiseMax(limits_.workspace_min()).cwiseMin(limits_.workspace_max());
    if (target != *command) note(LinkLimit::workspace);
    wanted = velocity_to(target, dt);
    last_target_ = target;
    if (!(force_base.norm() <= limits_.max_force)) {
      note(LinkLimit::force);
      wanted = without_pressing(wanted, force_base);
    }
  } else {
    last_target_.reset();
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double change = limits_.max_acceleration * dt;
    double v = std::clamp(wanted[axis], v_base_[axis] - change, v_base_[axis] + change);
    if (v != wanted[axis]) note(LinkLimit::acceleration);
    // Stops before the walls: this always lies within reach of the acceleration.
    const double up =
        braking_speed(limits_.workspace_max()[axis] - p_base_[axis], limits_.max_acceleration, dt);
    const double down =
        braking_speed(p_base_[axis] - limits_.workspace_min()[axis], limits_.max_acceleration, dt);
    v = std::clamp(v, -down, up);
    v_base_[axis] = std::clamp(v, -limits_.max_speed, limits_.max_speed);
  }
  p_base_ =
      (p_base_ + dt * v_base_).cwiseMax(limits_.workspace_min()).cwiseMin(limits_.workspace_max());
  return p_base_;
}

}  // namespace pcavr
