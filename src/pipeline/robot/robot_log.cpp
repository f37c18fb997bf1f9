// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/robot/robot_log.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace pcavr {

Error first_of(const std::vector<Error>& errors, const std::string& file) {
  Error error = errors.front();
  error.file = file;
  if (errors.size() > 1) error.message += fmt::format(" (and {} more faults)", errors.size() - 1);
  return error;
}

Expected<void> apply_gains(const std::vector<double>& gains, JointLog& log,
                           const std::string& file) {
  if (log.torque.rows() > 0) {
    if (gains.empty()) return {};
    return Error{.message = "has torques; gains are for currents",
                 .file = file,
                 .line = 1,
                 .hint = "omit --gains and --load-mass, or name the columns current_NAME"};
  }
  if (log.current.rows() == 0) {
    return Error{.message = "has neither torques nor currents",
                 .file = file,
                 .line = 1,
                 .hint = "add columns tau_NAME or current_NAME"};
  }
  if (gains.size() != log.joints.size()) {
    return Error{
        .message = fmt::format("has currents of {} joints, and {} gains are given",
                               log.joints.size(), gains.size()),
        .file = file,
        .line = 1,
        .hint =
            "give --gains with N m/A for each joint, in the order of the columns, or find them by "
            "--unloaded and --load-mass"};
  }
  log.torque = log.current;
  for (std::size_t j = 0; j < gains.size(); ++j) {
    log.torque.col(static_cast<Eigen::Index>(j)) *= gains[j];
  }
  return {};
}

Expected<SoundLog> sound_log(const JointLog& log, const RobotModel& model,
                             const RobotIdentificationOptions& options, const std::string& file) {
  Expected<MatchedRobot> matched = match_joints(log, model);
  if (!matched) return first_of({matched.error()}, file);
  SoundLog sound{*std::move(matched), {}, {}, {}, {}};
  sound.log = reordered(log, sound.matched.columns);
  LogFindings rows = check_rows(sound.log, sound.matched.model, options.signals.max_gap);
  if (!rows.errors.empty()) return first_of(rows.errors, file);
  sound.warnings = std::move(rows.warnings);
  sound.clock = correct_sample_clock(sound.log);
  sound.signals = joint_signals(sound.log, options.signals);
  if (sound.signals.position.rows() >= kMinFittedRows) return sound;
  return Error{
      .message = fmt::format("only {} rows are left for the fit", sound.signals.position.rows()),
      .file = file,
      .hint = "record a longer motion without gaps"};
}

std::string lag_text(const EstimatedLag& lag, const std::string& reference) {
  return fmt::format("torques are {:.3g} ± {:.2g} ms {} {}", std::abs(lag.value) * 1e3,
                     lag.std * 1e3, lag.value > 0.0 ? "after" : "before", reference);
}

Expected<void> check_lag(double lag, const RobotFitOptions& options, Error late,
                         std::vector<Error>& warnings) {
  if (std::abs(lag) <= options.usual_torque_lag) return {};
  late.place = "tau, all joints";
  late.hint = "shift their stamps";
  if (std::abs(lag) > options.max_torque_lag) {
    late.hint += ", or accept the lag by robot_identification.fit: max_torque_lag in --config";
    return late;
  }
  late.message += ": this lag is removed";
  warnings.push_back(std::move(late));
  return {};
}

}  // namespace pcavr
