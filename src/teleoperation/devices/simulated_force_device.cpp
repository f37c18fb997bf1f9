// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/simulated_force_device.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "teleoperation/devices/tip_bounds.hpp"

namespace pcavr {
namespace {

Eigen::Vector3d sway_and_dip(double t, double sway, double rate) {
  return {sway * std::sin(rate * t), 0.0, -0.5 * sway * (1.0 - std::cos(rate * t))};
}

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }
bool is_not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

SimulatedForceDevice::SimulatedForceDevice(SimulatedForceDeviceOptions options)
    : options_(std::move(options)), random_(options_.seed) {
  PCAVR_REQUIRE(is_positive(options_.hand_stiffness), options_.hand_stiffness);
  PCAVR_REQUIRE(is_not_negative(options_.hand_damping), options_.hand_damping);
  PCAVR_REQUIRE(is_positive(options_.mass), options_.mass);
  PCAVR_REQUIRE(is_not_negative(options_.friction), options_.friction);
  PCAVR_REQUIRE(is_not_negative(options_.force_noise), options_.force_noise);
  PCAVR_REQUIRE(is_positive(options_.max_force), options_.max_force);
  PCAVR_REQUIRE(is_not_negative(options_.sway), options_.sway);
  PCAVR_REQUIRE(is_positive(options_.sway_period), options_.sway_period);
  if (options_.target) return;
  const double rate = 2.0 * std::numbers::pi / options_.sway_period;  // [rad/s]
  options_.target = [sway = options_.sway, rate](double t) { return sway_and_dip(t, sway, rate); };
}

Eigen::Vector3d SimulatedForceDevice::motor_force(const Eigen::Vector3d& commanded) noexcept {
  if (!commanded.allFinite()) return Eigen::Vector3d::Zero();
  Eigen::Vector3d force = limit_distance(Eigen::Vector3d::Zero(), commanded, options_.max_force);
  for (double& axis : force) axis += options_.force_noise * random_.normal();
  return force;
}

DeviceSample SimulatedForceDevice::exchange(double t, double dt,
                                            const DeviceFeedback& feedback) noexcept {
  if (!has_begun_) {
    if (!is_plausible_tip(feedback.p_base_tool)) return {};
    has_begun_ = true;
    begin_ = t;
    p_base_tip_ = p_base_start_ = feedback.p_base_tool;
  }
  const Eigen::Vector3d target = p_base_start_ + options_.target(t - begin_);
  const Eigen::Vector3d force = motor_force(feedback.force_base);
  // v' = v + dt / m (k (target - x - dt v') - (b + f) v' + F), solved for v'.
  const double k = options_.hand_stiffness;
  const double b = options_.hand_damping + options_.friction;
  const Eigen::Vector3d impulse = dt * (k * (target - p_base_tip_) + force);
  v_base_tip_ = (options_.mass * v_base_tip_ + impulse) / (options_.mass + dt * b + dt * dt * k);
  p_base_tip_ += dt * v_base_tip_;
  motor_work_ += dt * force.dot(v_base_tip_);
  return {p_base_tip_, Eigen::Quaterniond::Identity(), true, true};
}

}  // namespace pcavr
