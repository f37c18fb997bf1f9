// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/devices/device.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct SimulatedForceDeviceOptions {
  SimulatedForceDeviceOptions();
  /// [m] target of the hand, relative to the initial tip, `t` [s] after the first exchange; finite,
  /// and must not throw or allocate. Empty: it moves by `sway` to either side and as far down.
  std::function<Eigen::Vector3d(double t)> target;
  double sway;            ///< [m]
  double sway_period;     ///< [s]
  double hand_stiffness;  ///< [N/m]
  double hand_damping;    ///< [N s/m]
  double mass;            ///< [kg] of hand and handle
  double friction;        ///< [N s/m] in the device's own joints
  double force_noise;     ///< [N] std per cycle, along each axis
  double max_force;       ///< [N] saturation of its motors
  std::uint64_t seed;     ///< of the noise
};
[[nodiscard]] OptionSection section_of(SimulatedForceDeviceOptions& options);

/// A simulated force-feedback device with a hand, to close the loop through the world without
/// hardware: a mass with a spring and a damper to the hand's target, and the world's force as
/// rendered by motors: saturated, then noisy. Always engaged. Deterministic.
///
/// The hand's spring and dampers are integrated implicitly, so they are stable and dissipative at
/// any `dt`; the world's force is applied explicitly.
class SimulatedForceDevice final : public Device {
 public:
  /// Options finite and in range: PCAVR_REQUIRE.
  explicit SimulatedForceDevice(SimulatedForceDeviceOptions options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "simulated force device"; }
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;

  [[nodiscard]] const Eigen::Vector3d& v_base_tip() const noexcept {
    return v_base_tip_;
  }  ///< [m/s]
  /// [J] energy that the motors have supplied to the hand so far. Passivity: at most 0, except for
  /// the noise.
  [[nodiscard]] double motor_work() const noexcept { return motor_work_; }

 private:
  [[nodiscard]] Eigen::Vector3d motor_force(const Eigen::Vector3d& commanded) noexcept;

  SimulatedForceDeviceOptions options_;
  Random random_;
  bool has_begun_ = false;
  double begin_ = 0.0;
  Eigen::Vector3d p_base_start_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_base_tip_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_base_tip_ = Eigen::Vector3d::Zero();
  double motor_work_ = 0.0;
};

}  // namespace pcavr
