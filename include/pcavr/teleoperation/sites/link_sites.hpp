// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/cycle_histogram.hpp"
#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/teleoperation/link/command_buffer.hpp"
#include "pcavr/teleoperation/link/delay_stages.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"
#include "pcavr/teleoperation/link/link_transport.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"
#include "pcavr/teleoperation/link/picture_pacer.hpp"
#include "pcavr/teleoperation/sites/operator_interface.hpp"
#include "pcavr/teleoperation/sites/robot_interface.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp
class BlackBox;        // sites/black_box.hpp
class PredictionSink;  // sites/prediction_sink.hpp

/// The main loops of `pcavr robot-site` and `pcavr operator-site`. Each runs on the caller's thread
/// until its end, a lasting fault, or `stop`.

struct RobotSiteOptions {
  RobotSiteOptions();
  double cycle;        ///< [s]
  double state_rate;   ///< [Hz]
  double start_delay;  ///< [s] from the first session to the beginning of a recording
  CommandOptions commands;
  MotionLimits limits;
  PictureOptions pictures;
};
/// The section without the nested options.
[[nodiscard]] OptionSection section_of(RobotSiteOptions& options);

/// Facts about the scene for a page and a log.
struct SiteScene {
  std::string name;
  std::string version;  ///< of the program
  std::vector<std::string> objects;
  double tool_radius = 0.01;              ///< [m]
  std::vector<Pose> T_base_objects = {};  ///< where the scene has them
};

struct RobotSiteReport {
  std::size_t sessions = 0;
  std::size_t holds = 0;  ///< by silence of the operator's site
  std::size_t emergency_stops = 0;
  std::size_t commands = 0;
  std::size_t discarded_commands = 0;
  std::size_t invalid_messages = 0;
  std::size_t repeated_corrections = 0;
  std::size_t correction_bytes = 0;
  std::size_t streaming_bytes = 0;
  std::size_t pictures = 0;  ///< sent
  std::size_t picture_bytes = 0;
  std::vector<SentCorrection> corrections;  ///< the first of them; times of the scene
  std::size_t cycles = 0;
  std::size_t late_cycles = 0;
  /// [s] CPU of any cycle's samples and corrections, without what threads identify and try.
  double max_correction_time = 0.0;
  double cpu = 0.0;                               ///< [s] of this thread
  std::optional<TipResponse> tool_response = {};  ///< of the robot's arm, if it was found
  std::vector<std::string> notes;
};

[[nodiscard]] Expected<RobotSiteReport> run_robot_site(
    LinkServer& server, RobotInterface& robot, LiveRobotSite& site, const SiteScene& scene,
    const RobotSiteOptions& options, const Observer& observer, const std::atomic<bool>& stop,
    BlackBox* black_box = nullptr, PredictionSink* predictions = nullptr);

struct OperatorSiteOptions {
  OperatorSiteOptions();
  double connection_timeout;  ///< [s] for the first session
  double timeout;             ///< [s] without a message of the robot's site: the link is lost
  double lead_margin;         ///< [s] by which commands shall arrive before their execution
  double correction_margin;   ///< [s] by which corrections shall arrive before they are applied
  double min_clock_time;      ///< [s] of round trips before the first command
};
[[nodiscard]] OptionSection section_of(OperatorSiteOptions& options);

/// Both directions of a simulated network, applied at the operator's site.
struct SimulatedNetwork {
  LinkConditions::Options forward;
  LinkConditions::Options backward;
  std::uint64_t seed = 1;
};

struct OperatorSiteReport {
  struct Interruption {
    double t = 0.0;         ///< [s] of the scene
    double duration = 0.0;  ///< [s] until commands were sent again
  };
  std::size_t sessions = 0;
  std::size_t commands = 0;
  std::size_t corrections = 0;           ///< applied
  std::size_t repeated_corrections = 0;  ///< received again, not applied again
  std::size_t late_corrections = 0;      ///< beyond the history
  std::size_t invalid_messages = 0;
  std::size_t pictures = 0;  ///< of the robot's camera, received
  double picture_age = 0.0;  ///< [s] when they arrived, their mean
  std::vector<Interruption> interruptions;
  double lead = 0.0;  ///< [s] from sending a command to its execution
  double correction_delay =
      0.0;                    ///< [s] until a command contains a correction, from its composition
  double round_trip = 0.0;    ///< [s] fastest
  double clock_offset = 0.0;  ///< [s] shared clock less this one, at the end
  double clock_drift = 0.0;
  double clock_std = 0.0;  ///< [s]
  std::size_t late_cycles = 0;
  CycleTimes cycle_times;           ///< of the world with its corrections and its command
  DelayMeans delays;                ///< of the states that named a command of this site
  double cpu = 0.0;                 ///< [s] of this thread
  std::vector<double> t_corrected;  ///< [s] times that the first corrections speak of
};

/// `interface` commands the tool in `world`, which the robot's site corrects.
[[nodiscard]] Expected<OperatorSiteReport> run_operator_site(
    LinkClient& client, OperatorInterface& interface, const TeleopInput& world,
    const TeleopOptions& teleop, const SiteScene& scene, const OperatorSiteOptions& options,
    const SimulatedNetwork& network, const Observer& observer, const std::atomic<bool>& stop,
    BlackBox* black_box = nullptr, PredictionSink* predictions = nullptr);

}  // namespace pcavr
