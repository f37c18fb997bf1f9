// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/robots/robot_identification/residual_spectrum.hpp"

#include "identify_robot_headline.hpp"
#include "identify_robot_json.hpp"

namespace pcavr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kHundred = 100.0;
constexpr double kMaxDrawnError = 20.0 / kDegrees;  ///< [rad] of a replay

/// No more digits than the std allows: "1.234 ± 0.056".
std::string with_std(double value, double std) {
  const UncertainText text = uncertain(value, std);
  return text.std == "-" ? text.value : text.value + " ± " + text.std;
}

/// Cells of a table: value, standard deviation.
void append_uncertain(std::vector<std::string>& row, double value, double std) {
  UncertainText text = uncertain(value, std);
  row.push_back(std::move(text.value));
  row.push_back(std::move(text.std));
}

std::vector<double> column_of(const Eigen::MatrixXd& values, Eigen::Index column) {
  return {values.col(column).begin(), values.col(column).end()};
}

ReportTable error_table(const RobotFit& fit) {
  ReportTable table{.title = "Torque error by joint",
                    .columns = {"joint", "fitted part (%)", "held-out part (%)",
                                "held-out part (N m)", "plain least squares, held out (%)"}};
  for (const JointFit& joint : fit.joints) {
    table.rows.push_back({joint.name, readable(joint.train.relative * kHundred),
                          readable(joint.held_out.relative * kHundred),
                          readable(joint.held_out.rms),
                          readable(joint.plain_held_out.relative * kHundred)});
  }
  table.note = fmt::format(
      "rms of measured less fitted torque over rms of the torque, of a fit of the first {} of {} "
      "rows; the parameters below are those of a fit of all rows. Plain: unweighted, without "
      "prior, Coulomb, viscous and offset alone.",
      fit.train_rows, fit.fitted_torque.rows());
  return table;
}

ReportTable coupling_table(const RobotIdentification& found) {
  ReportTable table{.title = "Motors that turn with two joints",
                    .columns = {"joints", "speed", "inertia (kg m²)", "viscous (N m s/rad)",
                                "Coulomb (N m)", "errors without it over those with it"}};
  for (const JointCoupling& coupling : found.couplings) {
    const std::string& carrier = found.fit.joints[coupling.carrier].name;
    const std::string& driven = found.fit.joints[coupling.driven].name;
    const auto text = [](const FittedTerm& term) { return with_std(term.value, term.std); };
    table.rows.push_back({carrier + ", " + driven,
                          fmt::format("{} {:+g} {}", driven, coupling.ratio, carrier),
                          text(coupling.inertia), text(coupling.viscous), text(coupling.coulomb),
                          readable(coupling.gain)});
  }
  table.note =
      "Found in the fitted part, by rows left out: the errors are the product of both joints'. "
      "The torques act on both joints, and are not in the joints' own friction below.";
  return table;
}

ReportTable gains_table(const std::vector<JointGain>& gains) {
  ReportTable table{.title = "Gains of the drives, by the load's mass",
                    .columns = {"joint", "gain (N m/A)", "± std"}};
  for (const JointGain& gain : gains) {
    append_uncertain(table.rows.emplace_back(std::vector{gain.joint}), gain.gain, gain.std);
  }
  return table;
}

ReportTable payload_table(const RobotFit& fit, const Payload& payload) {
  ReportTable table{.title = "Load", .columns = {"quantity", "value", "± std", "unit"}};
  const auto add = [&](const std::string& quantity, double value, double std, const char* unit) {
    std::vector<std::string>& row = table.rows.emplace_back(std::vector{quantity});
    append_uncertain(row, value, std);
    row.emplace_back(unit);
  };
  add("mass", payload.mass, payload.mass_std, "kg");
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    add(std::string("centre of mass, ") + kAxes[axis], payload.centre_of_mass[axis],
        payload.centre_of_mass_std[axis], "m");
  }
  table.note = "In the frame of the link behind joint " + fit.joints.back().name +
               ": what the loaded run's torques have beyond the unloaded arm's.";
  return table;
}

ReportTable contact_table(const RobotFit& fit, const ObservedContacts& contacts) {
  ReportTable table{.title = "Contact",
                    .columns = {"joint", "threshold within 50 ms (N m)",
                                "lowest threshold, median of the rows (N m)"}};
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    table.rows.push_back({fit.joints[j].name,
                          readable(contacts.thresholds[static_cast<Eigen::Index>(j)]),
                          readable(contacts.detectable_torque[static_cast<Eigen::Index>(j)])});
  }
  table.note = fmt::format(
      "External torque of a momentum observer, from the fitted rows; {} touches are found in the "
      "held-out rows. On the tip {}.",
      contacts.touches.size(), detectable_force_text(contacts));
  for (const ObservedContacts::JointTouch& touch : contacts.touches) {
    table.note +=
        fmt::format(" Touch at {:.3f} s, joint {}.", touch.t, fit.joints[touch.joint].name);
  }
  return table;
}

/// Paper A's trial beside the regression.
ReportTable trial_table(const RobotFit& fit, const FrictionTrial& trial) {
  ReportTable table{
      .title = "Friction by trial, as paper A has it, and by regression",
      .columns = {"joint", "found by", "viscous (N m s/rad)", "Coulomb (N m)",
                  "held-out torque error (%)", "position rms of the stretches (deg)"}};
  const auto add = [&](const JointFit& joint, const std::string& method,
                       const std::string& position) {
    table.rows.push_back({joint.name, method,
                          uncertain(joint.value_of(FrictionTerm::viscous), {}).value,
                          uncertain(joint.value_of(FrictionTerm::coulomb), {}).value,
                          readable(joint.held_out.relative * kHundred), position});
  };
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    add(fit.joints[j], "regression", "");
    add(trial.alone.joints[j], "trial, this joint alone",
        readable(trial.alone.position_rms[joint] * kDegrees));
    add(trial.together.joints[j], "trial, all joints",
        readable(trial.together.position_rms[joint] * kDegrees));
  }
  table.note = fmt::format(
      "Trial: recorded torques in, friction changed until the positions fit; {:.3g} s of motion "
      "were "
      "simulated, {:.0f} % of it one joint at a time. Bodies and motor inertia are those of the "
      "regression, which has further terms of friction, too.",
      trial.simulated_time, trial.alone_share * kHundred);
  return table;
}

ReportTable interval_table(const JointFit& joint, const JointIntervals& found) {
  ReportTable table{.title = "Friction by joint position",
                    .columns = {"from (deg)", "to (deg)", "rows", "offset (N m)",
                                "viscous (N m s/rad)", "Coulomb (N m)"},
                    .is_folded = true};
  for (const FrictionInterval& interval : found.intervals) {
    std::vector<std::string> row{readable(interval.begin * kDegrees),
                                 readable(interval.end * kDegrees),
                                 fmt::format("{}", interval.rows)};
    for (const FittedTerm& term : interval.terms) {
      row.push_back(with_std(term.value, term.std));
    }
    table.rows.push_back(std::move(row));
  }
  table.note = fmt::format("Held-out torque error with the table {}, with single values {} %.",
                           readable(found.held_out.relative * kHundred),
                           readable(joint.held_out.relative * kHundred));
  return table;
}

ReportTable friction_table(const JointFit& joint) {
  ReportTable table{.title = "Friction", .columns = {"term", "value", "± std", "unit", "excited"}};
  for (const FittedTerm& term : joint.friction) {
    std::vector<std::string>& row =
        table.rows.emplace_back(std::vector<std::string>{name_of(term.term)});
    append_uncertain(row, term.value, term.std);
    row.emplace_back(unit_of(term.term));
    row.emplace_back(term.is_excited ? "yes" : "no");
  }
  table.note =
      fmt::format("sign of the speed: tanh(speed / {:.3g} rad/s)", joint.sign.smoothing_speed);
  if (joint.sign.presliding_displacement > 0.0) {
    table.note = fmt::format("after a reversal the sign changes over {:.3g} mrad of motion",
                             1e3 * joint.sign.presliding_displacement);
  }
  if (joint.stribeck_speed > 0.0) {
    table.note += fmt::format("; Stribeck speed {:.3g} rad/s", joint.stribeck_speed);
  }
  table.note += ". As three parameters, with a sign that changes at once:";
  for (const FittedTerm& term : joint.equivalent) {
    table.note += fmt::format(" {} {} {}", name_of(term.term), with_std(term.value, term.std),
                              unit_of(term.term));
  }
  table.note += ".";
  return table;
}

ReportTable base_table(const RobotFit& fit) {
  ReportTable table{
      .title = "Base parameters",
      .columns = {"combination (SI)", "value", "± std", "std before the data", "excited"},
      .is_folded = true};
  for (const BaseParameter& entry : fit.base_parameters) {
    std::vector<std::string>& row = table.rows.emplace_back(std::vector{entry.name});
    append_uncertain(row, entry.value, entry.std);
    row.push_back(uncertain(entry.prior_std, {}).value);
    row.emplace_back(entry.is_excited ? "yes" : "no");
  }
  table.note =
      "What joint torques can show of masses m, first moments mx my mz and inertias of the joints' "
      "bodies, about and in their joint frames.";
  return table;
}

Plot torque_plot(const RobotIdentification& found, Eigen::Index joint) {
  Plot plot{.title = "Torque", .x_label = "time (s)", .y_label = "torque (N m)"};
  const Eigen::MatrixXd residual = found.signals.torque - found.fit.fitted_torque;
  plot.series = {{.label = "measured",
                  .color = 0,
                  .x = found.signals.t,
                  .y = column_of(found.signals.torque, joint)},
                 {.label = "fitted",
                  .color = 1,
                  .x = found.signals.t,
                  .y = column_of(found.fit.fitted_torque, joint)},
                 {.label = "measured less fitted",
                  .color = 2,
                  .x = found.signals.t,
                  .y = column_of(residual, joint)}};
  if (found.fit.train_rows < found.signals.t.size()) {
    plot.bands.push_back({found.signals.t[found.fit.train_rows], found.signals.t.back(), 0});
    plot.band_labels = {"held out"};
  }
  return plot;
}

/// A joint's simulated positions until they are kMaxDrawnError away from the recorded ones.
PlotSeries simulated_series(const MotionReplay& replay, const SimulatedMotion& motion,
                            Eigen::Index joint) {
  PlotSeries series;
  for (Eigen::Index row = 0; row < motion.position.rows(); ++row) {
    const double position = motion.position(row, joint);
    if (!(std::abs(position - replay.recorded(row, joint)) < kMaxDrawnError)) break;
    series.x.push_back(replay.t[static_cast<std::size_t>(row)]);
    series.y.push_back(position * kDegrees);
  }
  return series;
}

Plot replay_plot(const RobotIdentification& found, Eigen::Index joint) {
  const MotionReplay& replay = found.replay;
  Plot plot{.title = "Recorded torques in, positions out",
            .x_label = "time (s)",
            .y_label = "position (deg)"};
  plot.series = {{.label = "measured",
                  .color = 0,
                  .x = replay.t,
                  .y = column_of(replay.recorded * kDegrees, joint)},
                 simulated_series(replay, replay.alone, joint),
                 simulated_series(replay, replay.simulated, joint)};
  plot.series[1].label = "simulated, the other joints as recorded";
  plot.series[1].color = 1;
  plot.series[2].label = "simulated, all joints";
  plot.series[2].color = 2;
  plot.series[2].dashed = true;
  return plot;
}

Plot spectrum_plot(const RobotIdentification& found, Eigen::Index joint) {
  const ResidualSpectrum spectrum = residual_spectrum(
      found.signals.torque.col(joint) - found.fit.fitted_torque.col(joint), found.signals.interval);
  Plot plot{.title = "Spectrum of the torque error",
            .x_label = "frequency (Hz)",
            .y_label = "density (N m/√Hz)",
            .y_from_zero = true};
  plot.series = {{.label = "measured less fitted",
                  .color = 2,
                  .x = spectrum.frequency,
                  .y = spectrum.density}};
  return plot;
}

PageSection joint_section(const RobotIdentification& found, std::size_t index) {
  const auto joint = static_cast<Eigen::Index>(index);
  PageSection section{.title = found.fit.joints[index].name};
  std::vector<ReportTable> tables{friction_table(found.fit.joints[index])};
  if (index < found.intervals.size()) {
    tables.push_back(interval_table(found.fit.joints[index], found.intervals[index]));
  }
  section.blocks.emplace_back(std::move(tables));
  PlotGroup group{"Plots", {torque_plot(found, joint)}};
  if (!found.replay.t.empty()) group.plots.push_back(replay_plot(found, joint));
  group.plots.push_back(spectrum_plot(found, joint));
  section.blocks.emplace_back(std::move(group));
  return section;
}

/// The angle in degrees; no number where the simulation diverged.
std::string replay_text(double angle) {
  return std::isfinite(angle) ? readable(angle * kDegrees) : "without bound";
}

ReportTable replay_table(const RobotIdentification& found) {
  const MotionReplay& replay = found.replay;
  ReportTable table{.title = "Replay: recorded torques in, positions out",
                    .columns = {"joint", "alone, rms (deg)", "alone, within 3 deg (s)",
                                "all joints, after 1 s (deg)", "all joints, rms (deg)",
                                "torque error for 3 deg (N m)", "held-out torque error (N m)"}};
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    table.rows.push_back({found.fit.joints[j].name, replay_text(replay.alone.rms[joint]),
                          readable(replay.alone.kept[joint]), replay_text(replay.after_1s[joint]),
                          replay_text(replay.simulated.rms[joint]),
                          uncertain(replay.tolerable_torque[joint], {}).value,
                          readable(found.fit.joints[j].held_out.rms)});
  }
  table.note = fmt::format(
      "Simulated over {:.3g} s of the held-out part from its first state, drawn up to an error of "
      "{:.3g} deg; alone: the other joints follow the record. Torque error for 3 deg: a constant "
      "one of this joint's torque alone that moves some joint by 3 deg rms when all are simulated.",
      replay.t.back() - replay.t.front(), kMaxDrawnError * kDegrees);
  return table;
}

ReportPage robot_page(const RobotIdentification& found, const std::string& log,
                      const std::string& robot) {
  ReportPage page{.title = "Robot identification: " + log, .heading = "Identification of a robot"};
  page.inputs = {
      {{"log "}, {log, true}, {fmt::format(", {} rows", found.log.t.size())}},
      {{"robot description "}, {robot, true}},
      {{"filter "},
       {readable(found.signals.bandwidth) + " Hz", true},
       {fmt::format(" (-6 dB, zero phase); motion up to {:.3g} Hz",
                    found.signals.motion_frequency)}},
      {{"bodies: "},
       {found.fit.is_physical ? "physically possible" : "not physically possible", true}}};
  page.notes = found.notes;
  page.verdict = robot_verdict(found);
  page.headline = robot_headline(found);
  PageSection all{.title = "All joints"};
  std::vector<ReportTable> tables{error_table(found.fit)};
  if (!found.replay.t.empty()) tables.push_back(replay_table(found));
  if (found.trial) tables.push_back(trial_table(found.fit, *found.trial));
  if (!found.couplings.empty()) tables.push_back(coupling_table(found));
  if (!found.gains.empty()) tables.push_back(gains_table(found.gains));
  if (found.payload) tables.push_back(payload_table(found.fit, *found.payload));
  if (found.contacts) tables.push_back(contact_table(found.fit, *found.contacts));
  tables.push_back(base_table(found.fit));
  all.blocks.emplace_back(std::move(tables));
  page.sections.push_back(std::move(all));
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    page.sections.push_back(joint_section(found, j));
  }
  page.footer =
      "Std: standard deviation, for noise with the correlation of the residuals. The same "
      "figures in SI units are in report.json. pcavr " +
      std::string(PCAVR_VERSION);
  return page;
}

}  // namespace

Expected<void> write_robot_report(const RobotIdentification& found, const std::string& log,
                                  const std::string& robot, const std::filesystem::path& folder) {
  const Expected<void> written = write_report_page(robot_page(found, log, robot), folder);
  if (!written) return written;
  return write_file(folder / "report.json", robot_report_json(found, log, robot));
}

}  // namespace pcavr
