// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pcavr/core/json_text.hpp"
#include "pcavr/core/output.hpp"
#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/report/number_text.hpp"
#include "pcavr/report/report_page.hpp"
#include "pcavr/robot_identification/residual_spectrum.hpp"

#include "identify_robot_headline.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kHundred = 100.0;

std::string short_number(double value) { return fmt::format("{:.4g}", value); }

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

ReportTable gains_table(const std::vector<JointGain>& gains) {
  ReportTable table{.title = "Gains of the drives, by the load's mass",
                    .columns = {"joint", "gain (N m/A)", "± std"}};
  for (const JointGain& gain : gains) {
    table.rows.push_back({gain.joint, short_number(gain.gain), short_number(gain.std)});
  }
  return table;
}

ReportTable payload_table(const RobotFit& fit, const Payload& payload) {
  ReportTable table{.title = "Load", .columns = {"quantity", "value", "± std", "unit"}};
  table.rows.push_back({"mass", short_number(payload.mass), short_number(payload.mass_std), "kg"});
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    table.rows.push_back({std::string("centre of mass, ") + kAxes[axis],
                          short_number(payload.centre_of_mass[axis]),
                          short_number(payload.centre_of_mass_std[axis]), "m"});
  }
  table.note = "In the frame of the link behind joint " + fit.joints.back().name +
               ": what the loaded run's torques have beyond the unloaded arm's.";
  return table;
}

ReportTable contact_table(const RobotFit& fit, const ObservedContacts& contacts) {
  ReportTable table{.title = "Contact", .columns = {"joint", "threshold (N m)"}};
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    table.rows.push_back(
        {fit.joints[j].name, readable(contacts.thresholds[static_cast<Eigen::Index>(j)])});
  }
  table.note = fmt::format(
      "External torque of a momentum observer, from the fitted rows; {} touches are found in the "
      "held-out rows. A force of {:.3g} N on the tip is found.",
      contacts.touches.size(), contacts.detectable_force);
  for (const ObservedContacts::Touch& touch : contacts.touches) {
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
    table.rows.push_back({joint.name, method, short_number(joint.value_of(FrictionTerm::viscous)),
                          short_number(joint.value_of(FrictionTerm::coulomb)),
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
      row.push_back(short_number(term.value) + " ± " + fmt::format("{:.2g}", term.std));
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
    table.rows.push_back({name_of(term.term), short_number(term.value), short_number(term.std),
                          unit_of(term.term), term.is_excited ? "yes" : "no"});
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
    table.note += fmt::format(" {} {} ± {:.2g} {}", name_of(term.term), short_number(term.value),
                              term.std, unit_of(term.term));
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
    table.rows.push_back({entry.name, short_number(entry.value), short_number(entry.std),
                          short_number(entry.prior_std), entry.is_excited ? "yes" : "no"});
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

Plot replay_plot(const RobotIdentification& found, Eigen::Index joint) {
  Plot plot{.title = "Recorded torques in, positions out",
            .x_label = "time (s)",
            .y_label = "position (deg)"};
  plot.series = {{.label = "measured",
                  .color = 0,
                  .x = found.replay.t,
                  .y = column_of(found.replay.recorded * kDegrees, joint)},
                 {.label = "simulated",
                  .color = 1,
                  .x = found.replay.t,
                  .y = column_of(found.replay.simulated * kDegrees, joint),
                  .dashed = true}};
  return plot;
}

Plot spectrum_plot(const RobotIdentification& found, Eigen::Index joint) {
  const ResidualSpectrum spectrum = residual_spectrum(
      found.signals.torque.col(joint) - found.fit.fitted_torque.col(joint), found.signals.interval);
  Plot plot{.title = "Spectrum of the torque error",
            .x_label = "frequency (Hz)",
            .y_label = "amplitude density (N m/√Hz)",
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
  if (found.replay.is_finite) group.plots.push_back(replay_plot(found, joint));
  group.plots.push_back(spectrum_plot(found, joint));
  section.blocks.emplace_back(std::move(group));
  return section;
}

ReportTable replay_table(const RobotIdentification& found) {
  ReportTable table{.title = "Replay: recorded torques in, positions out",
                    .columns = {"joint", "error after 1 s (deg)", "rms (deg)",
                                "torque error for 3 deg (N m)", "held-out torque error (N m)"}};
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const auto joint = static_cast<Eigen::Index>(j);
    table.rows.push_back({found.fit.joints[j].name,
                          readable(found.replay.after_1s[joint] * kDegrees),
                          readable(found.replay.rms[joint] * kDegrees),
                          readable(found.replay.tolerable_torque[joint]),
                          readable(found.fit.joints[j].held_out.rms)});
  }
  table.note = fmt::format(
      "Simulated over {:.3g} s of the held-out part from its first state. Torque error for 3 deg: "
      "a constant one of this joint's torque alone that moves some joint by 3 deg rms.",
      found.replay.t.back() - found.replay.t.front());
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
  if (found.replay.is_finite) tables.push_back(replay_table(found));
  if (found.trial) tables.push_back(trial_table(found.fit, *found.trial));
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

void add_trial(Json& json, const std::string& key, const TrialStage& stage, std::size_t index) {
  const JointFit& joint = stage.joints[index];
  json[key + "viscous"] = joint.value_of(FrictionTerm::viscous);
  json[key + "coulomb"] = joint.value_of(FrictionTerm::coulomb);
  json[key + "held_out.relative_error"] = joint.held_out.relative;
  json[key + "held_out.rms_error"] = joint.held_out.rms;
  json[key + "position_rms_rad"] = stage.position_rms[static_cast<Eigen::Index>(index)];
}

void add_intervals(Json& json, const std::string& key, const JointIntervals& found) {
  for (const FrictionInterval& interval : found.intervals) {
    Json entry{{"begin", interval.begin}, {"end", interval.end}, {"rows", interval.rows}};
    for (const FittedTerm& term : interval.terms) {
      entry[name_of(term.term)] = term.value;
      entry[std::string(name_of(term.term)) + "_std"] = term.std;
    }
    json[key + "intervals"].push_back(entry);
  }
  json[key + "intervals.held_out.relative_error"] = found.held_out.relative;
}

void add_joint(Json& json, const RobotIdentification& found, std::size_t index) {
  const JointFit& joint = found.fit.joints[index];
  const std::string key = "joint." + joint.name + ".";
  for (const FittedTerm& term : joint.friction) {
    json[key + name_of(term.term)] = term.value;
    json[key + name_of(term.term) + "_std"] = term.std;
    json[key + name_of(term.term) + ".is_excited"] = term.is_excited;
  }
  for (const FittedTerm& term : joint.equivalent) {
    const std::string name = key + "equivalent." + name_of(term.term);
    json[name] = term.value;
    json[name + "_std"] = term.std;
  }
  json[key + "smoothing_speed"] = joint.sign.smoothing_speed;
  if (joint.sign.presliding_displacement > 0.0) {
    json[key + "presliding_displacement"] = joint.sign.presliding_displacement;
  }
  if (joint.stribeck_speed > 0.0) json[key + "stribeck_speed"] = joint.stribeck_speed;
  json[key + "noise_std"] = joint.noise_std;
  json[key + "train.relative_error"] = joint.train.relative;
  json[key + "held_out.relative_error"] = joint.held_out.relative;
  json[key + "held_out.rms_error"] = joint.held_out.rms;
  json[key + "plain.held_out.relative_error"] = joint.plain_held_out.relative;
  if (index < found.intervals.size()) add_intervals(json, key, found.intervals[index]);
  if (found.trial) {
    add_trial(json, key + "grid.alone.", found.trial->alone, index);
    add_trial(json, key + "grid.together.", found.trial->together, index);
  }
  if (!found.replay.is_finite) return;
  json[key + "replay.after_1s_rad"] = found.replay.after_1s[static_cast<Eigen::Index>(index)];
  json[key + "replay.kept_s"] = found.replay.kept[static_cast<Eigen::Index>(index)];
  json[key + "replay.tolerable_torque"] =
      found.replay.tolerable_torque[static_cast<Eigen::Index>(index)];
  json[key + "replay.rms_rad"] = found.replay.rms[static_cast<Eigen::Index>(index)];
}

Json touches_json(const ObservedContacts& contacts) {
  Json json = Json::array();
  for (const ObservedContacts::Touch& touch : contacts.touches) {
    Json entry{{"t", touch.t}, {"joint", touch.joint}};
    entry["force"] = nullptr;
    if (touch.force_base) {
      entry["force"] = {touch.force_base->x(), touch.force_base->y(), touch.force_base->z()};
    }
    json.push_back(entry);
  }
  return json;
}

std::string format_json(const RobotIdentification& found, const std::string& log,
                        const std::string& robot) {
  Json json;
  json["format"] = "pcavr-identification/1";
  json["version"] = PCAVR_VERSION;
  json["log"] = log;
  json["robot"] = robot;
  json["units"] = "SI";
  for (const auto& [key, value] : found.configuration) json["configuration"][key] = value;
  json["rows"] = found.log.t.size();
  json["fitted_rows"] = found.fit.train_rows;
  json["filter.bandwidth_Hz"] = found.signals.bandwidth;
  json["motion_frequency_Hz"] = found.signals.motion_frequency;
  json["torque_lag_s"] = found.fit.torque_lag;
  json["torque_sign"] = found.signals.is_sign_changed ? -1 : 1;
  json["prior_scale"] = found.fit.prior_scale;
  json["is_physical"] = found.fit.is_physical;
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) add_joint(json, found, j);
  const Eigen::VectorXd& inertias = found.fit.inertial_parameters;
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const Eigen::VectorXd body = inertias.segment<10>(static_cast<Eigen::Index>(10 * j));
    json["joint." + found.fit.joints[j].name + ".inertial_parameters"] =
        std::vector<double>(body.begin(), body.end());
  }
  for (const BaseParameter& entry : found.fit.base_parameters) {
    json["base_parameters"].push_back({{"name", entry.name},
                                       {"value", entry.value},
                                       {"std", entry.std},
                                       {"is_excited", entry.is_excited}});
  }
  if (found.contacts) {
    json["contact.detectable_force"] = found.contacts->detectable_force;
    json["contact.touches"] = touches_json(*found.contacts);
    for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
      json["joint." + found.fit.joints[j].name + ".contact_threshold"] =
          found.contacts->thresholds[static_cast<Eigen::Index>(j)];
    }
  }
  for (const JointGain& gain : found.gains) {
    json["joint." + gain.joint + ".gain"] = gain.gain;
    json["joint." + gain.joint + ".gain_std"] = gain.std;
  }
  if (found.payload) {
    json["payload.mass"] = found.payload->mass;
    json["payload.mass_std"] = found.payload->mass_std;
    for (int axis = 0; axis < 3; ++axis) {
      json["payload.centre_of_mass"].push_back(found.payload->centre_of_mass[axis]);
      json["payload.centre_of_mass_std"].push_back(found.payload->centre_of_mass_std[axis]);
    }
  }
  json["notes"] = found.notes;
  return json_text(json, 2) + '\n';
}

}  // namespace

Expected<void> write_robot_report(const RobotIdentification& found, const std::string& log,
                                  const std::string& robot, const std::filesystem::path& folder) {
  const Expected<void> written = write_report_page(robot_page(found, log, robot), folder);
  if (!written) return written;
  return write_file(folder / "report.json", format_json(found, log, robot));
}

}  // namespace pcavr
