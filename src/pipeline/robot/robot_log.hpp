// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr {

inline constexpr Eigen::Index kMinFittedRows = 100;

/// The first error with the log's name; the number of further ones in its message.
[[nodiscard]] Error first_of(const std::vector<Error>& errors, const std::string& file);

/// Torques from currents; the log is left as it is where it has torques and there are no gains.
[[nodiscard]] Expected<void> apply_gains(const std::vector<double>& gains, JointLog& log,
                                         const std::string& file);

/// A log whose rows have no faults.
struct SoundLog {
  MatchedRobot matched;
  JointLog log;  ///< by the model's joints, unwrapped
  SampleClock clock;
  JointSignals signals;
  std::vector<Error> warnings;  ///< of its rows
};

/// Matches a log with torques to the model, and checks its rows.
[[nodiscard]] Expected<SoundLog> sound_log(const JointLog& log, const RobotModel& model,
                                           const RobotIdentificationOptions& options,
                                           const std::string& file);

/// "torques are 20 ± 0.3 ms after `reference`".
[[nodiscard]] std::string lag_text(const EstimatedLag& lag, const std::string& reference);

/// Adds `late`, the finding of a lag [s] of all torques, to the warnings where it is beyond a
/// drive's filter; fails with it where the lag is too long to be removed.
[[nodiscard]] Expected<void> check_lag(double lag, const RobotFitOptions& options, Error late,
                                       std::vector<Error>& warnings);

}  // namespace pcavr
