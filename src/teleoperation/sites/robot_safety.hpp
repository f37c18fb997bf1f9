// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"

#include "site_reporter.hpp"

namespace pcavr {

/// Whether and where the robot's tool may go: holds, the emergency stop, and the limits of its
/// motion, which no message lifts.
class RobotSafety {
 public:
  RobotSafety(const MotionLimits& limits, const Eigen::Vector3d& p_base_start)
      : limiter_(limits, p_base_start) {}

  /// Executes a hold, a stop or a release. True if an emergency stop began.
  bool apply(LinkStop stop, double now, SiteReporter& reporter) {
    switch (stop) {
      case LinkStop::hold:
        is_on_hold_ = true;
        break;
      case LinkStop::resume:
        if (!is_stopped_) is_on_hold_ = false;
        break;
      case LinkStop::emergency_stop:
        if (!is_stopped_) reporter.warn(now, "emergency stop: the tool holds until its release");
        is_on_hold_ = true;
        return !std::exchange(is_stopped_, true);
      case LinkStop::reset:
        if (is_stopped_) reporter.note(now, "the emergency stop was released: on hold");
        is_stopped_ = false;
        break;
    }
    return false;
  }

  /// The tool comes to rest without an operator.
  void begin_session() { has_silence_hold_ = false; }
  void end_session() {
    is_engaged_ = false;
    target_.reset();
  }
  /// Holds until the operator resumes.
  void hold() { is_on_hold_ = true; }
  /// Holds until the next session.
  void hold_for_silence() { has_silence_hold_ = true; }

  void command(const LinkCommand& command) {
    is_engaged_ = command.is_engaged;
    target_ = command.p_base_tip.cast<double>();
    q_base_tool_ = command.q_base_tool.cast<double>().normalized();
  }
  /// Sets where the tip shall be between two commands.
  void lead_to(const Eigen::Vector3d& p_base_tip) { target_ = p_base_tip; }
  /// The setpoint did not move for a while: it has no speed.
  void halt() { limiter_.halt(); }
  /// The setpoint of the next cycle of `dt` [s]; `force_base` [N]: what the tool exerts.
  void step(bool has_session, const Eigen::Vector3d& force_base, double dt) {
    const bool may_move = has_session && is_engaged_ && !is_on_hold_ && !is_stopped_;
    limiter_.step(may_move ? target_ : std::nullopt, force_base, dt);
    limits_ |= limiter_.active();
  }
  [[nodiscard]] const Eigen::Vector3d& p_base() const { return limiter_.p_base(); }
  [[nodiscard]] const Eigen::Quaterniond& q_base_tool() const { return q_base_tool_; }

  /// Adds to a state what it says of safety, with the limits that have acted since the last call.
  void describe(LinkState& state) {
    state.limits = std::exchange(limits_, 0U);
    state.is_engaged = is_engaged_;
    state.is_on_hold = is_on_hold_ || has_silence_hold_;
    state.is_stopped = is_stopped_;
  }

 private:
  MotionLimiter limiter_;
  bool is_engaged_ = false;
  bool is_on_hold_ = false;        ///< until the operator resumes
  bool is_stopped_ = false;        ///< emergency stop
  bool has_silence_hold_ = false;  ///< until the next session
  std::optional<Eigen::Vector3d> target_;
  Eigen::Quaterniond q_base_tool_ = Eigen::Quaterniond::Identity();
  std::uint32_t limits_ = 0;
};

}  // namespace pcavr
