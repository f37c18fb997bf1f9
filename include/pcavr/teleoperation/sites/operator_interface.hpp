// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/link/delay_stages.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

namespace pcavr {

/// Knowledge of an operator's site about the link in one cycle. Times [s] are CLOCK_MONOTONIC.
struct OperatorLink {
  double now = 0.0;
  bool is_connected = false;         ///< in a session: commands are executed
  double silence = 0.0;              ///< [s] since the last message of the robot's site
  double lead = 0.0;                 ///< [s] from sending a command to its execution
  double round_trip = 0.0;           ///< [s] fastest
  double clock_std = 0.0;            ///< [s]
  const LinkState* robot = nullptr;  ///< its newest state in this session
  /// Of the newest command whose effect has come back, in this session.
  std::optional<DelayStamps> delays = {};
};

/// The operator's command of one cycle.
struct OperatorCommand {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  bool is_engaged = false;  ///< the clutch is closed
  /// [s] on the device's clock: the motion that the tip shows. None: no device.
  std::optional<double> device_clock = {};
};

/// Requests of the operator to the robot's site besides motion, until its state agrees.
struct OperatorRequests {
  std::optional<bool> is_stopped = {};  ///< emergency stop, or its release
  std::optional<bool> is_on_hold = {};
};

/// The operator of an operator's site: a recorded motion, a page. Called from the site's thread;
/// must not block.
class OperatorInterface {
 public:
  virtual ~OperatorInterface() = default;

  /// Whether it makes no sense with a robot that moves as it was recorded.
  [[nodiscard]] virtual bool needs_follower() const { return false; }
  /// [s] of the recorded motion at cycle 0.
  [[nodiscard]] virtual double start() const { return 0.0; }
  /// Number of cycles after which it ends; nothing: it does not end.
  [[nodiscard]] virtual std::optional<std::size_t> cycles() const { return std::nullopt; }

  /// A session begins: where the tip is before cycle `next`. `robot`: its newest state, if it
  /// follows commands and the state is known.
  [[nodiscard]] virtual Eigen::Vector3d p_base_start(std::size_t next, const LinkState* robot) = 0;
  /// The world of the session that begins; valid until end().
  virtual void begin(LiveOperatorSite&) {}
  /// Moves the tool in the world by one cycle: steps `site` once.
  [[nodiscard]] virtual OperatorCommand step(std::size_t cycle, LiveOperatorSite& site,
                                             const OperatorLink& link) = 0;
  /// The session has ended: the clutch is open.
  virtual void end() {}
  /// Called in place of step() without a session, at least every 20 ms.
  virtual void wait(const OperatorLink&) {}
  /// Shows what the robot's camera saw at `t` [s] of CLOCK_MONOTONIC; each picture is newer than
  /// the last.
  virtual void show_picture(const LinkPicture& /*picture*/, double /*t*/) {}
  /// Requests since the last call.
  [[nodiscard]] virtual OperatorRequests take_requests() { return {}; }
};

/// The tool's recorded motion in `world` as the operator, smoothed as in run_teleop. A robot that
/// follows commands is led to its begin first, in a straight line at 0.1 m/s. Keeps a
/// reference to it. An Error if the motion has fewer than two samples.
[[nodiscard]] Expected<std::unique_ptr<OperatorInterface>> make_recorded_operator(
    const TeleopInput& world, const TeleopOptions& options);

}  // namespace pcavr
