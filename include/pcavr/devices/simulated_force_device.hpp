// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "pcavr/core/random.hpp"
#include "pcavr/devices/device.hpp"

namespace pcavr {

struct SimulatedForceDeviceOptions {
  /// [m] where the hand wants the tip, from where it was at first, `t` [s] after the first
  /// exchange; finite, and neither throws nor allocates. Empty: it sways 5 cm to either side and
  /// dips 5 cm, once in 4 s.
  std::function<Eigen::Vector3d(double t)> target = {};
  double hand_stiffness = 400.0;  ///< [N/m] > 0; a relaxed grip has some hundreds
  double hand_damping = 10.0;     ///< [N s/m] >= 0; with the mass, just under critical
  double mass = 0.2;              ///< [kg] > 0 of hand and handle, as a desk device is felt
  double friction = 0.5;          ///< [N s/m] >= 0 in the device's own joints
  double force_noise = 0.02;      ///< [N] >= 0, standard deviation a cycle, along each axis
  double max_force = 5.0;         ///< [N] > 0 that its motors give
  std::uint64_t seed = 1;         ///< of the noise
};

/// A force device and a hand that are simulated, so that the loop through the world is closed
/// without either: a mass, a spring and a damper to where the hand wants to be, and the world's
/// force with what motors make of it: saturated, then noisy. Always engaged. Deterministic.
///
/// The hand's spring and dampers are integrated implicitly, stable and losing energy at any `dt`;
/// the world's force is what it is.
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
  /// [J] that the motors put into the hand so far. Passive, they take out what they put in before,
  /// and more: never above 0 but for the noise.
  [[nodiscard]] double motor_work() const noexcept { return motor_work_; }

 private:
  [[nodiscard]] Eigen::Vector3d motor_force(const Eigen::Vector3d& asked) noexcept;

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
