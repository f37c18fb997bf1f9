// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr {

/// The state of a device in one cycle.
struct DeviceSample {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m] position of its tip
  Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  bool is_engaged = false;  ///< the clutch is closed
  bool is_present = false;  ///< false: unplugged, timed out, or at its end
  /// Its emergency stop is held, or was pressed since the last exchange; also of an absent device.
  bool is_stop_pressed = false;
};

/// Feedback to a device in one cycle.
struct DeviceFeedback {
  Eigen::Vector3d p_base_tool =
      Eigen::Vector3d::Zero();  ///< [m] position of the tool, where a clutch engages
  /// [N] rendered on the hand, at its grip. Devices of three axes render this alone.
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();
  double pulse = 0.0;  ///< 0 to 1: vibration amplitude for devices without force feedback
  Eigen::Vector3d torque_base = Eigen::Vector3d::Zero();  ///< [N m] on the hand, about its grip
};

/// An operator's input device. `exchange` is called by one thread at 1 kHz, and never allocates,
/// locks, blocks or throws; blocking driver calls are made in a thread of the device's own.
class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// `t` [s] ascends, in steps of about `dt`.
  [[nodiscard]] virtual DeviceSample exchange(double t, double dt,
                                              const DeviceFeedback& feedback) noexcept = 0;
};

}  // namespace pcavr
