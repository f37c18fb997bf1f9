// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

namespace pcavr {

struct OptionSection;                  // core/options.hpp
enum class LinkLimit : std::uint32_t;  // link/link_message.hpp

/// Limits of the tool's motion at the robot's site, which no message can change
/// ("robot_site.limits").
struct MotionLimits {
  MotionLimits();
  double max_speed;         ///< [m/s] along each axis
  double max_acceleration;  ///< [m/s^2] along each axis
  double max_step;          ///< [m] that the command may be ahead of the tool, along each axis
  double max_overshoot;     ///< [m] past a command that stops at once, along each axis
  double max_force;         ///< [N] that the tool may exert
  double min_x, max_x;      ///< [m] of the workspace, base frame
  double min_y, max_y;
  double min_z, max_z;

  [[nodiscard]] Eigen::Vector3d workspace_min() const { return {min_x, min_y, min_z}; }
  [[nodiscard]] Eigen::Vector3d workspace_max() const { return {max_x, max_y, max_z}; }
  /// [s] in which a hold ends any motion.
  [[nodiscard]] double max_hold_time() const { return max_speed / max_acceleration; }
};
[[nodiscard]] OptionSection section_of(MotionLimits& options);

/// The setpoint of the tool's position, which follows its commands within the limits: every cycle's
/// setpoint satisfies them, whatever is commanded. It does not lag behind a command that moves so
/// slowly that it could stop within max_overshoot. Not thread-safe.
class MotionLimiter {
 public:
  /// The tool rests at `p_base_tip`, inside the workspace (else at its nearest point). Throws
  /// ContractError for limits out of range.
  MotionLimiter(const MotionLimits& limits, const Eigen::Vector3d& p_base_tip);

  /// One cycle of `dt` [s]. Without a command, or with one that is not finite, the tool is ramped
  /// to rest. `force_base` [N]: what the tool exerts now.
  const Eigen::Vector3d& step(const std::optional<Eigen::Vector3d>& command,
                              const Eigen::Vector3d& force_base, double dt);

  /// No setpoint was given for a while: the tool rests at the last one.
  void halt() { v_base_.setZero(); }

  [[nodiscard]] const Eigen::Vector3d& p_base() const { return p_base_; }
  [[nodiscard]] const Eigen::Vector3d& v_base() const { return v_base_; }
  /// LinkLimit bits: which of them changed the last cycle.
  [[nodiscard]] std::uint32_t active() const { return active_; }

 private:
  [[nodiscard]] Eigen::Vector3d velocity_to(const Eigen::Vector3d& p_base, double dt);
  void note(LinkLimit limit) { active_ |= static_cast<std::uint32_t>(limit); }

  MotionLimits limits_;
  Eigen::Vector3d p_base_;
  Eigen::Vector3d v_base_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> last_target_ = {};  ///< of the cycle before [m]
  std::uint32_t active_ = 0;
};

}  // namespace pcavr
