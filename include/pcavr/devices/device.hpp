// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pcavr {

/// What a device says, once a cycle.
struct DeviceSample {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m] where its tip is
  Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  bool is_engaged = false;  ///< the clutch is held
  bool is_present = false;  ///< false: unplugged, silent for too long, or at its end
};

/// What it is told, once a cycle.
struct DeviceFeedback {
  Eigen::Vector3d p_base_tool =
      Eigen::Vector3d::Zero();  ///< [m] where the tool is: a clutch starts here
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< [N] on the hand
  double pulse = 0.0;  ///< 0 to 1: what a device that has no force shakes with instead
};

/// What an operator holds. `exchange` is called by one thread at 1 kHz, and neither allocates,
/// locks, blocks nor throws; what has to wait for a driver waits in a thread of the device's own.
class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// `t` [s] ascends, in steps of about `dt`.
  [[nodiscard]] virtual DeviceSample exchange(double t, double dt,
                                              const DeviceFeedback& feedback) noexcept = 0;
};

}  // namespace pcavr
