// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "pcavr/core/random.hpp"
#include "pcavr/devices/device.hpp"

namespace pcavr {

struct SimulatedForceDeviceOptions {
  /// [m] target of the hand, relative to the initial tip, `t` [s] after the first exchange; finite,
  /// and must not throw or allocate. Empty: it moves 5 cm to either side and 5 cm down, with a
  /// period of 4 s.
  std::function<Eigen::Vector3d(double t)> target = {};
  double hand_stiffness = 400.0;  ///< [N/m] > 0; a relaxed grip has some hundreds
  double hand_damping = 10.0;     ///< [N s/m] >= 0; with the mass, slightly underdamped
  double mass = 0.2;      ///< [kg] > 0 of hand and handle, the apparent mass of a desktop device
  double friction = 0.5;  ///< [N s/m] >= 0 in the device's own joints
  double force_noise = 0.02;  ///< [N] >= 0, std per cycle, along each axis
  double max_force = 5.0;     ///< [N] > 0 saturation of its motors
  std::uint64_t seed = 1;     ///< of the noise
};

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
