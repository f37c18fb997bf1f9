// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What two runs of an arm show, of which one carries a load.
#include <cmath>

#include <fmt/format.h>

#include "pcavr/robots/robot_identification/drive_gains.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "pipeline/robot/robot_log.hpp"

namespace pcavr {
namespace {

constexpr double kMaxGainStd = 0.3;  ///< relative: above, a drive's gain is not determined

/// Its torques are the currents [A].
Expected<SoundLog> currents_of(const NamedLog& named, const RobotModel& model,
                               const RobotIdentificationOptions& options) {
  JointLog log = named.log;
  const std::vector<double> ones(log.joints.size(), 1.0);
  if (Expected<void> applied = apply_gains(ones, log, named.file); !applied) {
    return applied.error();
  }
  return sound_log(log, model, options, named.file);
}

/// Covariance of the relative errors of the gains by the model's joints; empty where torques were
/// recorded. `columns`: those of the log, by joint. Gains that a known load showed have stds of
/// their own.
Eigen::MatrixXd gain_covariance(const RobotIdentificationOptions& options,
                                const std::vector<JointGain>& identified,
                                const std::vector<std::size_t>& columns) {
  if (options.gains.empty()) return {};
  const auto dof = static_cast<Eigen::Index>(columns.size());
  if (identified.empty()) return given_gain_covariance(dof, options.payload.gain_std);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(dof, dof);
  for (Eigen::Index j = 0; j < dof; ++j) {
    const JointGain& gain = identified[columns[static_cast<std::size_t>(j)]];
    covariance(j, j) = std::pow(gain.std / gain.gain, 2);
  }
  return covariance;
}

}  // namespace

Expected<void> add_payload(JointLog loaded, const RobotIdentificationOptions& options,
                           const std::string& file, const RobotModel& model,
                           RobotIdentification& found) {
  if (Expected<void> applied = apply_gains(options.gains, loaded, file); !applied) return applied;
  Expected<SoundLog> sound = sound_log(loaded, model, options, file);
  if (!sound) return sound.error();
  if (sound->matched.model.dof != found.model.dof) {
    return Error{.message = "has other joints than the log of the unloaded arm",
                 .file = file,
                 .line = 1,
                 .hint = "record the same joints in both runs"};
  }
  LogFindings shown = check_hypotheses(sound->signals, found.model);
  if (!shown.errors.empty()) return first_of(shown.errors, file);
  if (sound->signals.is_sign_changed != found.signals.is_sign_changed) {
    return Error{.message = "its torques have the opposite sign of the unloaded arm's",
                 .file = file,
                 .line = 1,
                 .hint = "record the same columns in both runs"};
  }
  for (std::vector<Error>* warnings : {&sound->warnings, &shown.warnings}) {
    for (Error& warning : *warnings) {
      warning.file = file;
      found.notes.push_back(warning.to_string());
    }
  }
  remove_couplings(found.couplings, sound->signals, sound->log);
  found.payload = identify_payload(sound->signals, found.model, found.fit,
                                   gain_covariance(options, found.gains, sound->matched.columns));
  const EstimatedLag& lag = found.payload->torque_lag;
  return check_lag(lag.value, options.fit,
                   {.message = lag_text(lag, "those of the unloaded run"),
                    .file = file,
                    .line = sound->signals.lines.front()},
                   found.warnings);
}

Expected<std::vector<JointGain>> find_drive_gains(const NamedLog& unloaded, const NamedLog& loaded,
                                                  const RobotModel& model, double load_mass,
                                                  const RobotIdentificationOptions& options) {
  if (unloaded.log.joints != loaded.log.joints) {
    return Error{.message = "has other joints, or another order of them, than " + unloaded.file,
                 .file = loaded.file,
                 .line = 1,
                 .hint = "record the same columns in both runs"};
  }
  const Expected<SoundLog> without = currents_of(unloaded, model, options);
  if (!without) return without.error();
  const Expected<SoundLog> with = currents_of(loaded, model, options);
  if (!with) return with.error();
  const DriveGains found = identify_drive_gains(without->signals, with->signals,
                                                without->matched.model, load_mass, options.fit);
  std::vector<JointGain> gains(without->matched.columns.size());
  for (std::size_t j = 0; j < gains.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    JointGain& gain = gains[without->matched.columns[j]];
    gain = {without->matched.model.joints[j].name, found.gain[joint], found.std[joint]};
    if (std::isfinite(gain.gain) && gain.std < kMaxGainStd * std::abs(gain.gain)) continue;
    return Error{
        .message = fmt::format("joint {}: its gain is {:.3g} +- {:.2g} N m/A, not determined",
                               gain.joint, gain.gain, gain.std),
        .file = loaded.file,
        .hint = "move it faster, or give --gains"};
  }
  return gains;
}

}  // namespace pcavr
