// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/robot_interface.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

#include "site_log.hpp"
#include "tool_response.hpp"

namespace pcavr {

/// [s] on the shared clock.
struct ExecutedCommand {
  double t = 0.0;  ///< of execution, as the operator's site wanted it
  double received = 0.0;
  double applied = 0.0;  ///< when it became the setpoint
};

/// Measurements of the robot, for the site's identification and for its states, and the command
/// that they show.
class RobotMeasurement {
 public:
  /// The robot's setpoint, if it follows commands; `t` [s] of the scene.
  void add_setpoint(double t, const Eigen::Vector3d& p_base) { response_.add_setpoint(t, p_base); }
  /// Takes what the robot has measured up to `now`; `start` [s]: time zero of the scene.
  void advance(double now, double start, RobotInterface& robot, LiveRobotSite& site, SiteLog& log);
  [[nodiscard]] const Eigen::Vector3d& force_base() const { return force_base_; }
  /// Whether the last advance() left out a sample because it is not finite, or the robot failed.
  [[nodiscard]] bool has_fault() const { return samples_.has_fault || failure_; }
  /// Why the robot failed in the last advance(), if it did.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

  /// Response of the robot's arm, once it is known.
  [[nodiscard]] const std::optional<TipResponse>& tool_response() const {
    return response_.value();
  }
  void add(const ExecutedCommand& executed) { unsensed_.push_back(executed); }
  /// Call it at the end of a session.
  void forget_commands() { unsensed_.clear(); }

  /// Adds them to a state. Without `start` nothing was measured yet.
  void describe(double now, std::optional<double> start, const LiveRobotSite& site,
                LinkState& state);

 private:
  void leave_out_faulty();
  void sense(double t);

  RobotSamples samples_;
  std::optional<Error> failure_;
  RobotSamples::Tool tool_;
  Eigen::Vector3d force_base_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_base_ = Eigen::Vector3d::Zero();
  std::vector<std::optional<TrackedPose>> tracked_;
  std::deque<ExecutedCommand> unsensed_;  ///< later than the newest sample
  ExecutedCommand sensed_;                ///< the newest of the others
  ToolResponse response_;
};

}  // namespace pcavr
