// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify_robot.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "pipeline/robot/robot_log.hpp"
#include "pipeline/robot/torque_scale.hpp"
#include "pipeline/robot/unexplained_torque.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinLogRows = 200;  ///< fewer can't determine some eighty unknowns
constexpr double kReplayDuration = 5.0;   ///< [s]

std::string text_of(const Error& finding) {
  std::string text = finding.place.empty() ? "" : finding.place + ": ";
  text += finding.message;
  if (finding.line > 0) text += fmt::format(" (line {})", finding.line);
  return text;
}

std::vector<std::string> signal_notes(const JointSignals& signals, const SampleClock& clock) {
  std::vector<std::string> notes;
  if (clock.is_corrected) {
    notes.push_back(fmt::format(
        "rows were read out of step with the controller: its cycle is {:.4g} ms, {} rows repeat a "
        "sample and {} samples are missing; stamps were replaced by whole cycles",
        clock.tick * 1e3, clock.repeated, clock.skipped));
  }
  if (signals.rows_at_rest > 0) {
    notes.push_back(fmt::format("{} rows at rest are left out: friction is not determined there",
                                signals.rows_at_rest));
  }
  if (signals.velocity_disagreement) {
    notes.push_back(fmt::format(
        "recorded velocities are {:.2g} ms after the positions and differ by {:.2g} %; {} used",
        signals.velocity_lag * 1e3, *signals.velocity_disagreement * 1e2,
        signals.is_velocity_recorded ? "they are" : "the positions' derivatives are"));
  }
  return notes;
}

std::string text_of_lag(const RobotFit& fit) {
  return lag_text({fit.torque_lag, fit.torque_lag_std}, "the positions");
}

std::vector<std::string> fit_notes(const RobotIdentification& found) {
  std::vector<std::string> notes;
  const RobotFit& fit = found.fit;
  if (std::abs(fit.torque_lag) > 3.0 * fit.torque_lag_std) {
    notes.push_back(text_of_lag(fit) + "; removed");
  }
  if (!found.model.has_inertia()) {
    notes.emplace_back(
        "the robot description has no masses: bodies of 3 kg are the prior, and currents in place "
        "of torques can't be detected");
  }
  return notes;
}

/// Notes what is unexcited in the reported fit: the one of all rows.
void note_unexcited(RobotIdentification& found) {
  const std::size_t all = found.fit.base_parameters.size();
  const std::size_t unexcited = all - found.fit.excited_base_parameters();
  if (unexcited == 0) return;
  found.notes.push_back(fmt::format(
      "{} of {} base parameters are not excited by the motion: their values are the prior's",
      unexcited, all));
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The fits of the joints that move.
std::vector<JointFit> moving_fits(const RobotIdentification& found) {
  std::vector<JointFit> fits;
  const std::vector<bool> moving = moving_joints(found.signals);
  for (std::size_t j = 0; j < moving.size(); ++j) {
    if (moving[j]) fits.push_back(found.fit.joints[j]);
  }
  return fits;
}

/// Friction of a joint that rests is not known: what its creeping torque makes of it is left out.
void drop_friction_at_rest(RobotIdentification& found) {
  const std::vector<bool> moving = moving_joints(found.signals);
  for (std::size_t j = 0; j < moving.size(); ++j) {
    if (moving[j]) continue;
    JointFit& joint = found.fit.joints[j];
    joint.equivalent.clear();
    for (FittedTerm& term : joint.friction) term.is_excited = false;
  }
}

/// Names the joints of which twice the usual lag would not show.
void note_unseen_lags(const RobotFitOptions& options, const std::vector<JointFit>& fits,
                      RobotIdentification& found) {
  std::string joints;
  for (const JointFit& joint : fits) {
    const double visible = joint.visible_lag(options.usual_torque_lag);
    const bool is_named = joint.seems_out_of_step(options.usual_torque_lag);
    if (is_named || visible <= 2.0 * options.usual_torque_lag) continue;
    joints +=
        fmt::format("{}{} below {:.2g} ms", joints.empty() ? "" : ", ", joint.name, visible * 1e3);
  }
  if (joints.empty()) return;
  found.notes.push_back(
      "torques of one joint that are out of step with the others would not show in "
      "this motion: " +
      joints);
}

/// Names joints whose torques are out of step with the others': a warning where it is not friction
/// that looks so, else a note. Nothing is removed. Where one joint moves there are no others.
void check_joint_lags(const RobotFitOptions& options, const std::string& file,
                      RobotIdentification& found) {
  const std::vector<JointFit> fits = moving_fits(found);
  if (fits.size() < 2) return;
  for (const JointFit& joint : fits) {
    if (!joint.seems_out_of_step(options.usual_torque_lag)) continue;
    const std::string text =
        fmt::format("torques {} {:.3g} ± {:.2g} ms {} those of all joints",
                    joint.is_out_of_step(options.usual_torque_lag) ? "are" : "seem",
                    std::abs(joint.torque_lag.value) * 1e3, joint.torque_lag.std * 1e3,
                    joint.torque_lag.value > 0.0 ? "after" : "before");
    if (!joint.is_out_of_step(options.usual_torque_lag)) {
      found.notes.push_back(fmt::format(
          "joint {}: {}; friction after reversals looks so, too: check that they are from the same "
          "cycle of the controller",
          joint.name, text));
      continue;
    }
    found.warnings.push_back({.message = text + "; this is not removed",
                              .file = file,
                              .line = found.signals.lines.front(),
                              .place = "joint " + joint.name,
                              .hint = "check that they are from the same cycle of the controller"});
  }
  note_unseen_lags(options, fits, found);
}

/// Friction takes power from a joint's motion. Where it gives some, decidedly, the joint's torques
/// have another sign than the other joints', or than its positions.
Expected<void> check_friction_power(const std::string& file, const RobotIdentification& found) {
  constexpr double kDecisive = 5.0;    // stds
  constexpr double kMinOfNoise = 2.0;  // of the residual, which the wrong sign makes large
  const std::vector<bool> moving = moving_joints(found.signals);
  for (std::size_t j = 0; j < moving.size(); ++j) {
    if (!moving[j]) continue;
    const JointFit& joint = found.fit.joints[j];
    const auto speeds = found.signals.velocity.col(static_cast<Eigen::Index>(j));
    const double speed = std::sqrt(speeds.squaredNorm() / static_cast<double>(speeds.size()));
    double friction = 0.0, variance = 0.0;
    for (const FittedTerm& term : joint.equivalent) {
      if (term.term == FrictionTerm::offset) continue;
      const double by = term.term == FrictionTerm::viscous ? speed : 1.0;
      friction += by * term.value;
      variance += by * by * term.std * term.std;
    }
    const double least = std::max(kDecisive * std::sqrt(variance), kMinOfNoise * joint.noise_std);
    if (friction >= -least) continue;
    return Error{.message = fmt::format("friction of {:.3g} +- {:.2g} N m at {:.2g} rad/s would "
                                        "drive the joint: its torques have the opposite sign of "
                                        "the other joints', or of its positions",
                                        friction, std::sqrt(variance), speed),
                 .file = file,
                 .place = "joint " + joint.name,
                 .hint = "change the sign of its column of torques, or of positions"};
  }
  return {};
}

/// Puts the fit of all rows in place of the one that was judged on the held-out ones, whose errors
/// stay.
void fit_all_rows(const RobotIdentificationOptions& options, RobotIdentification& found) {
  RobotFit& judged = found.fit;
  if (judged.train_rows == found.signals.t.size()) return;
  RobotFitOptions of_all = options.fit;
  of_all.train_share = 1.0;
  RobotFit whole = fit_robot(found.signals, found.model, of_all);
  for (std::size_t j = 0; j < whole.joints.size(); ++j) {
    whole.joints[j].train = judged.joints[j].train;
    whole.joints[j].held_out = judged.joints[j].held_out;
    whole.joints[j].plain_held_out = judged.joints[j].plain_held_out;
  }
  whole.train_rows = judged.train_rows;
  whole.fitted_torque = std::move(judged.fitted_torque);
  found.fit = std::move(whole);
}

/// The torques of transmissions that two joints share, beside the recorded torques.
struct CoupledTorque {
  Eigen::MatrixXd recorded, coupling;  ///< [N m] row by row of the signals
};

/// Finds couplings, and takes their torques out of signals and log.
CoupledTorque take_couplings(const RobotFitOptions& options, RobotIdentification& found) {
  if (options.are_couplings_tried) {
    found.couplings = find_couplings(found.signals, found.model, options.train_share);
  }
  CoupledTorque torque{found.signals.torque, coupling_torque(found.couplings, found.signals)};
  remove_couplings(found.couplings, found.signals, found.log);
  for (const JointCoupling& coupling : found.couplings) {
    found.notes.push_back(fmt::format(
        "a motor turns with joints {} and {} (speed of {} {:+g} times that of {}): inertia {:.3g} "
        "kg m^2, viscous {:.3g} N m s/rad, Coulomb {:.3g} N m at both; without it both joints' "
        "errors in rows left out are {:.3g} times as large together; replay, contacts and load are "
        "looked at without these torques",
        found.model.joints[coupling.carrier].name, found.model.joints[coupling.driven].name,
        found.model.joints[coupling.driven].name, coupling.ratio,
        found.model.joints[coupling.carrier].name, coupling.inertia.value, coupling.viscous.value,
        coupling.coulomb.value, coupling.gain));
  }
  return torque;
}

/// Puts the couplings' torques back: signals and fitted torque are those of the log, and errors are
/// relative to its torques.
void return_couplings(CoupledTorque torque, RobotIdentification& found) {
  if (found.couplings.empty()) return;
  const auto train = static_cast<Eigen::Index>(found.fit.train_rows);
  const auto rms = [](const auto& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
  };
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const auto without = found.signals.torque.col(column), with = torque.recorded.col(column);
    const Eigen::Index rest = with.size() - train;
    JointFit& joint = found.fit.joints[j];
    joint.train.relative *= rms(without.head(train)) / rms(with.head(train));
    if (rest == 0) continue;
    const double share = rms(without.tail(rest)) / rms(with.tail(rest));
    joint.held_out.relative *= share;
    joint.plain_held_out.relative *= share;
  }
  found.fit.fitted_torque += torque.coupling;
  found.signals.torque = std::move(torque.recorded);
}

Expected<void> add_trial(const FrictionTrialOptions& options, const std::string& file,
                         RobotIdentification& found) {
  if (!found.fit.is_physical) {
    return Error{.message = "--method grid simulates the arm, and the bodies are not possible",
                 .file = file,
                 .hint = "leave robot_identification.fit: physical at 1, or correct the URDF"};
  }
  const Clock::time_point start = Clock::now();
  found.trial = try_friction(found.signals, found.model, found.fit, options);
  found.trial_time = seconds_since(start);
  if (found.trial) return {};
  return Error{
      .message = fmt::format("has no stretch of {:.3g} s without a gap in the fitted part, "
                             "which --method grid simulates",
                             options.stretch),
      .file = file,
      .hint = "record a longer motion, or lower robot_identification.grid: stretch"};
}

}  // namespace

Expected<JointLog> read_joint_log(const std::filesystem::path& file_or_folder, bool skip_bad) {
  std::error_code code;
  const bool is_folder = std::filesystem::is_directory(file_or_folder, code);
  const std::filesystem::path file = is_folder ? file_or_folder / "joints.csv" : file_or_folder;
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<Series<JointLog>> log =
      parse_joint_log({.file = file.string(), .text = *text, .skip_bad = skip_bad});
  if (!log) return log.error();
  return std::move(log->content);
}

Expected<RobotIdentification> identify_robot(JointLog log, const RobotModel& model,
                                             const RobotIdentificationOptions& options,
                                             const std::string& file) {
  if (log.t.size() < kMinLogRows) {
    return Error{.message = fmt::format("has {} rows, fewer than {}", log.t.size(), kMinLogRows),
                 .file = file,
                 .hint = "record a motion of at least some seconds"};
  }
  if (Expected<void> applied = apply_gains(options.gains, log, file); !applied) {
    return applied.error();
  }
  Expected<SoundLog> sound = sound_log(log, model, options, file);
  if (!sound) return sound.error();
  RobotIdentification found{.model = std::move(sound->matched.model),
                            .log = std::move(sound->log),
                            .clock = sound->clock,
                            .signals = std::move(sound->signals),
                            .fit = {},
                            .contacts = {},
                            .payload = {},
                            .intervals = {},
                            .trial = {},
                            .replay = {},
                            .notes = std::move(sound->matched.notes),
                            .warnings = {},
                            .configuration = {}};
  const LogFindings shown = check_hypotheses(found.signals, found.model);
  if (!shown.errors.empty()) return first_of(shown.errors, file);
  for (const std::vector<Error>& warnings : {sound->warnings, shown.warnings}) {
    for (const Error& warning : warnings) found.notes.push_back(text_of(warning));
  }
  for (std::string& note : signal_notes(found.signals, found.clock)) {
    found.notes.push_back(std::move(note));
  }
  CoupledTorque coupled = take_couplings(options.fit, found);
  if (!options.gains.empty()) {
    found.notes.emplace_back(
        "torques are currents times gains: an error of a gain is one of its joint's torques, "
        "friction and bodies, and of all stds only the load's contains it");
  }
  const Clock::time_point before_fit = Clock::now();
  found.fit = fit_robot(found.signals, found.model, options.fit);
  found.fit_time = seconds_since(before_fit);
  const Expected<void> checked = check_lag(
      found.fit.torque_lag, options.fit,
      {.message = text_of_lag(found.fit), .file = file, .line = found.signals.lines.front()},
      found.warnings);
  if (!checked) return checked.error();
  check_joint_lags(options.fit, file, found);
  for (std::string& note : fit_notes(found)) found.notes.push_back(std::move(note));
  found.intervals = friction_by_interval(found.signals, found.model, found.fit, options.intervals);
  if (options.is_trial_wanted) {
    if (Expected<void> tried = add_trial(options.trial, file, found); !tried) return tried.error();
  }
  const std::size_t first = std::min(found.fit.train_rows, found.signals.t.size() - std::size_t{2});
  const std::size_t excited = found.fit.excited_base_parameters();
  const std::size_t all = found.fit.base_parameters.size();
  const bool is_excited = excited > 0 && excited >= all / 4;  // else the model is the prior's
  const std::vector<bool> moving = moving_joints(found.signals);
  const bool do_all_move = std::find(moving.begin(), moving.end(), false) == moving.end();
  if (!is_excited) {
    found.notes.push_back(
        fmt::format("contacts are not looked for: the motion excites {} of {} base parameters, too "
                    "few to predict torques",
                    excited, all));
  } else if (!do_all_move) {
    found.notes.emplace_back(
        "contacts are not looked for: a joint rests, and its torque follows no model");
  }
  if (found.fit.is_physical && is_excited && do_all_move) {
    found.contacts =
        observe_contacts(found.log, found.model, found.fit, found.signals.is_sign_changed,
                         found.signals.t[first], default_tip(found.model), options.contact);
    found.replay =
        replay_motion(found.log, found.signals, found.fit, found.model, first, kReplayDuration);
    if (!found.replay.simulated.is_finite) {
      found.notes.push_back(
          fmt::format("the held-out torques move the simulated arm as recorded, within 3 deg, for "
                      "{:.2g} s, then without bound: of the replay of all joints together no "
                      "further figure is stated",
                      found.replay.simulated.kept.minCoeff()));
    }
  }
  fit_all_rows(options, found);
  return_couplings(std::move(coupled), found);
  drop_friction_at_rest(found);
  if (Expected<void> possible = check_friction_power(file, found); !possible) {
    return possible.error();
  }
  doubt_torque_scale(found);
  doubt_unexplained_torque(found);
  note_unexcited(found);
  return found;
}

}  // namespace pcavr
