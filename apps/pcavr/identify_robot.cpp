// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify_robot.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "commands.hpp"
#include "identify_plan.hpp"
#include "identify_robot.hpp"
#include "number_option.hpp"
#include "output_option.hpp"

namespace pcavr::app {
namespace {

constexpr InputRange kLoadMass{"mass of the load", 1e-3, 1e4, "kg",
                               "from a finger's load to that of the largest arms"};

struct RobotArguments {
  std::string log;
  std::string robot;
  std::string unloaded;
  OutputOption report;
  std::string plan;
  std::vector<double> gains;
  double load_mass = 0.0;  ///< [kg] 0: not given
  std::string method = "regression";
  bool is_body_known = false;
  bool skip_bad = false;
};

std::string joint_line(const JointFit& joint) {
  std::string line = fmt::format("    {:<24} {:>7.3g} % {:>8.3g} N m  ", joint.name,
                                 joint.held_out.relative * 100.0, joint.held_out.rms);
  for (const FittedTerm& term : joint.equivalent) {
    const UncertainText text = uncertain(term.value, term.std);
    line += fmt::format(" {} {} +- {} {}", name_of(term.term), text.value, text.std,
                        unit_of(term.term));
  }
  if (joint.equivalent.empty()) line += " rests: its friction is not determined";
  return line + '\n';
}

void add_replay(const MotionReplay& replay, Eigen::Index joint, nlohmann::ordered_json& json) {
  if (replay.t.empty()) return;
  json["replay_kept"] = replay.simulated.kept[joint];
  json["replay_tolerable_torque"] = replay.tolerable_torque[joint];
  json["replay_alone_kept"] = replay.alone.kept[joint];
  if (replay.alone.is_finite) json["replay_alone_rms"] = replay.alone.rms[joint];
  if (!replay.simulated.is_finite) return;
  json["replay_after_1s"] = replay.after_1s[joint];
  json["replay_rms"] = replay.simulated.rms[joint];
}

nlohmann::ordered_json joint_json(const RobotIdentification& found, std::size_t index) {
  const JointFit& joint = found.fit.joints[index];
  nlohmann::ordered_json json{{"name", joint.name},
                              {"held_out_relative_error", joint.held_out.relative},
                              {"held_out_rms_error", joint.held_out.rms},
                              {"plain_held_out_relative_error", joint.plain_held_out.relative},
                              {"train_relative_error", joint.train.relative}};
  for (const FittedTerm& term : joint.friction) {
    json[name_of(term.term)] = term.value;
    json[std::string(name_of(term.term)) + "_std"] = term.std;
  }
  for (const FittedTerm& term : joint.equivalent) {
    json[std::string("equivalent_") + name_of(term.term)] = term.value;
    json[std::string("equivalent_") + name_of(term.term) + "_std"] = term.std;
  }
  if (index < found.intervals.size()) {
    json["intervals_held_out_relative_error"] = found.intervals[index].held_out.relative;
  }
  add_replay(found.replay, static_cast<Eigen::Index>(index), json);
  return json;
}

void describe_replay(const RobotIdentification& found, CommandResult& result) {
  if (found.replay.t.empty()) return;
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const MotionReplay& replay = found.replay;
  const double duration = replay.t.back() - replay.t.front();
  result.summary += fmt::format(
      "replay of held-out torques, each joint alone, the others as recorded: within 3 deg for, of "
      "{:.2g} s:\n   ",
      duration);
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    result.summary += fmt::format(" {} {:.2g} s", found.fit.joints[j].name,
                                  replay.alone.kept[static_cast<Eigen::Index>(j)]);
  }
  result.summary += '\n';
  if (!replay.simulated.is_finite) return;
  Eigen::Index joint = 0;
  const double tolerable = replay.tolerable_torque.minCoeff(&joint);
  const JointFit& weakest = found.fit.joints[static_cast<std::size_t>(joint)];
  result.summary += fmt::format(
      "replay of all joints: position error after 1 s up to {:.2g} deg, rms over {:.2g} s up "
      "to {:.2g} deg, all within 3 deg for {:.2g} s\n"
      "    3 deg rms would need torques of {} within {:.2g} N m; its held-out error is {:.2g} N "
      "m\n",
      replay.after_1s.maxCoeff() * kDegrees, duration, replay.simulated.rms.maxCoeff() * kDegrees,
      replay.simulated.kept.minCoeff(), weakest.name, tolerable, weakest.held_out.rms);
}

void describe_contacts(const RobotIdentification& found, CommandResult& result) {
  if (!found.contacts) return;
  const ObservedContacts& contacts = *found.contacts;
  result.json["contact"] = {{"detectable_force", contacts.detectable_force},
                            {"usual_detectable_force", contacts.usual_detectable_force},
                            {"detectable_torque", nlohmann::ordered_json::object()},
                            {"touches", nlohmann::ordered_json::array()}};
  for (const ObservedContacts::JointTouch& touch : contacts.touches) {
    nlohmann::ordered_json json{{"t", touch.t}, {"joint", found.fit.joints[touch.joint].name}};
    if (touch.force_base) {
      json["force"] = {touch.force_base->x(), touch.force_base->y(), touch.force_base->z()};
    }
    result.json["contact"]["touches"].push_back(json);
    result.summary += fmt::format("touch at {:.3f} s, by joint {}\n", touch.t,
                                  found.fit.joints[touch.joint].name);
  }
  result.summary += fmt::format(
      "contact: {} touches in the held-out rows; on the tip {};\n    at one joint alone (N m):",
      contacts.touches.size(), detectable_force_text(contacts));
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const double torque = contacts.detectable_torque[static_cast<Eigen::Index>(j)];
    result.json["contact"]["detectable_torque"][found.fit.joints[j].name] = torque;
    result.summary += fmt::format(" {} {:.3g}", found.fit.joints[j].name, torque);
  }
  result.summary += '\n';
}

void describe_gains(const RobotIdentification& found, CommandResult& result) {
  for (const JointGain& gain : found.gains) {
    result.json["gains"].push_back({{"joint", gain.joint}, {"gain", gain.gain}, {"std", gain.std}});
    const UncertainText text = uncertain(gain.gain, gain.std);
    result.summary += fmt::format("gain of {}: {} +- {} N m/A\n", gain.joint, text.value, text.std);
  }
}

void describe_payload(const RobotIdentification& found, CommandResult& result) {
  if (!found.payload) return;
  const Payload& payload = *found.payload;
  const Eigen::Vector3d& centre = payload.centre_of_mass;
  result.json["payload"] = {{"mass", payload.mass},
                            {"mass_std", payload.mass_std},
                            {"centre_of_mass", {centre.x(), centre.y(), centre.z()}}};
  const UncertainText mass = uncertain(payload.mass, payload.mass_std);
  const auto coordinate = [&](int axis) {
    return uncertain(centre[axis], payload.centre_of_mass_std[axis]).value;
  };
  result.summary += fmt::format(
      "load: {} +- {} kg at ({}, {}, {}) m in the frame behind joint {}\n", mass.value, mass.std,
      coordinate(0), coordinate(1), coordinate(2), found.fit.joints.back().name);
}

/// Paper A's trial beside the regression.
void describe_trial(const RobotIdentification& found, CommandResult& result) {
  if (!found.trial) return;
  const FrictionTrial& trial = *found.trial;
  result.summary += fmt::format(
      "grid: {:.3g} s of motion simulated in {:.2g} s; regression: {:.2g} s\n"
      "    joint                    held-out torque error (%), viscous (N m s/rad), Coulomb (N m): "
      "regression, one joint's trial, all\n",
      trial.simulated_time, found.trial_time, found.fit_time);
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const JointFit& alone = trial.alone.joints[j];
    const JointFit& together = trial.together.joints[j];
    const auto value = [](const JointFit& joint, FrictionTerm term) {
      return joint.value_of(term);
    };
    result.summary += fmt::format(
        "    {:<24} {:>7.3g} {:>7.3g} {:>7.3g} %   viscous {:.3g} {:.3g} {:.3g}, coulomb {:.3g} "
        "{:.3g} {:.3g}\n",
        alone.name, found.fit.joints[j].held_out.relative * 100.0, alone.held_out.relative * 100.0,
        together.held_out.relative * 100.0, value(found.fit.joints[j], FrictionTerm::viscous),
        value(alone, FrictionTerm::viscous), value(together, FrictionTerm::viscous),
        value(found.fit.joints[j], FrictionTerm::coulomb), value(alone, FrictionTerm::coulomb),
        value(together, FrictionTerm::coulomb));
    for (const auto& [key, stage] : {std::pair{"grid_alone", &alone}, {"grid", &together}}) {
      result.json["joints"][j][key] = {{"viscous", value(*stage, FrictionTerm::viscous)},
                                       {"coulomb", value(*stage, FrictionTerm::coulomb)},
                                       {"held_out_relative_error", stage->held_out.relative}};
    }
  }
  result.json["grid"] = {{"simulated_time", trial.simulated_time},
                         {"computing_time", found.trial_time},
                         {"regression_computing_time", found.fit_time}};
}

CommandResult describe(const RobotIdentification& found, const RobotArguments& arguments) {
  CommandResult result;
  result.summary =
      fmt::format("{} rows, filter {:.3g} Hz, {} of {} base parameters excited, bodies {}\n",
                  found.log.t.size(), found.signals.bandwidth, found.fit.excited_base_parameters(),
                  found.fit.base_parameters.size(),
                  found.fit.is_physical ? "physically possible" : "not physically possible");
  for (const std::string& note : found.notes) result.summary += "note: " + note + '\n';
  result.summary +=
      "    joint                    held-out torque error (rms over the torque's rms, and rms, in "
      "rows that were not fitted), friction as three parameters\n";
  result.json = {{"report", arguments.report.folder},
                 {"bandwidth_hz", found.signals.bandwidth},
                 {"torque_lag", found.fit.torque_lag},
                 {"is_torque_sign_changed", found.signals.is_sign_changed},
                 {"is_physical", found.fit.is_physical}};
  result.json["joints"] = nlohmann::ordered_json::array();
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    result.summary += joint_line(found.fit.joints[j]);
    result.json["joints"].push_back(joint_json(found, j));
  }
  describe_replay(found, result);
  describe_trial(found, result);
  describe_contacts(found, result);
  describe_gains(found, result);
  describe_payload(found, result);
  result.json["notes"] = found.notes;
  result.summary += how_to_open(arguments.report.folder) + '\n';
  return result;
}

std::vector<std::filesystem::path> inputs_of(const RobotArguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.log, arguments.robot};
  if (!arguments.unloaded.empty()) inputs.emplace_back(arguments.unloaded);
  return inputs;
}

/// Sets the gains of `options`, by --gains or by a load of known mass; returns those of the load.
Expected<std::vector<JointGain>> gains_of(const RobotArguments& arguments, const JointLog& fitted,
                                          const std::optional<JointLog>& loaded,
                                          const RobotModel& model,
                                          RobotIdentificationOptions& options) {
  options.gains = arguments.gains;
  if (arguments.load_mass == 0.0) return std::vector<JointGain>{};
  Expected<std::vector<JointGain>> found = find_drive_gains(
      {fitted, arguments.unloaded}, {*loaded, arguments.log}, model, arguments.load_mass, options);
  if (!found) return found.error();
  for (const JointGain& gain : *found) options.gains.push_back(gain.gain);
  return found;
}

Expected<CommandResult> run_robot(const RobotArguments& arguments, Configuration& configuration,
                                  const Observer& observer) {
  Expected<OutputFolder> folder =
      create_output(arguments.report, OutputKind::report, inputs_of(arguments));
  if (!folder) return folder.error();
  std::optional<OutputFile> plan_file;
  if (!arguments.plan.empty()) {
    const Expected<void> apart =
        check_outputs({arguments.plan, arguments.report.folder}, inputs_of(arguments));
    if (!apart) return apart.error();
    Expected<OutputFile> created = create_plan_file(arguments.plan, arguments.report.replace);
    if (!created) return created.error();
    plan_file = *std::move(created);
  }
  const Expected<RobotModel> model = read_urdf(arguments.robot);
  if (!model) return model.error();
  for (const Error& warning : model->warnings) {
    // Shapes have no part in it.
    const bool is_of_shape = warning.message.find("visual") != std::string::npos ||
                             warning.message.find("collision") != std::string::npos ||
                             warning.place.find("visual") != std::string::npos ||
                             warning.place.find("collision") != std::string::npos;
    if (!is_of_shape) observer.on_warning(warning.to_string());
  }
  const std::string& fitted = arguments.unloaded.empty() ? arguments.log : arguments.unloaded;
  const Expected<JointLog> log = read_joint_log(fitted, arguments.skip_bad);
  if (!log) return log.error();
  std::optional<JointLog> loaded;
  if (!arguments.unloaded.empty()) {
    Expected<JointLog> read = read_joint_log(arguments.log, arguments.skip_bad);
    if (!read) return read.error();
    loaded = *std::move(read);
  }
  RobotIdentificationOptions options = configuration.robot_identification;
  options.fit.known_body |= arguments.is_body_known;
  Expected<std::vector<JointGain>> gains = gains_of(arguments, *log, loaded, *model, options);
  if (!gains) return gains.error();
  options.is_trial_wanted = arguments.method == "grid";
  Expected<RobotIdentification> found = identify_robot(*log, *model, options, fitted);
  if (!found) return found.error();
  found->gains = *std::move(gains);
  Expected<void> added;
  if (loaded) added = add_payload(*std::move(loaded), options, arguments.log, *model, *found);
  for (const Error& warning : found->warnings) observer.on_warning(warning.to_string());
  if (!added) return added.error();
  found->configuration = configuration.changed();
  const Expected<void> written =
      write_robot_report(*found, fitted, arguments.robot, folder->path());
  if (!written) return written.error();
  CommandResult result = describe(*found, arguments);
  Expected<void> committed;
  if (plan_file) {
    const ExcitingMotion motion =
        plan_exciting_motion(found->signals, found->model, found->fit, options.plan);
    committed = plan_file->write(format_motion(motion, found->model));
    if (committed) committed = plan_file->commit();
    if (!committed) return committed.error();
    add_plan(motion, found->fit, arguments.plan, result);
  }
  committed = folder->commit();
  if (committed) return result;
  if (plan_file) plan_file->undo();
  return committed.error();
}

}  // namespace

void add_identify_robot(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "robot", "Inertias and joint friction of an arm from its positions and torques");
  command->footer(
      "Example:\n  pcavr identify robot my_log/joints.csv --robot arm.urdf -o arm_report");
  auto arguments = std::make_shared<RobotArguments>();
  command
      ->add_option("log", arguments->log,
                   "Recording with joints.csv, or such a file: t, q_NAME, and tau_NAME or "
                   "current_NAME for each joint")
      ->required();
  command->add_option("--robot", arguments->robot, "Robot description (URDF)")->required();
  command->add_option("--unloaded", arguments->unloaded,
                      "Log of the same arm without its load: fitted in place of LOG, and the load "
                      "of LOG is identified");
  add_output_option(*command, arguments->report, "Folder for the report");
  command->add_option("--plan", arguments->plan,
                      "CSV file to write with a motion (t, q_NAME) that excites bodies and "
                      "friction better, within the recorded range");
  command
      ->add_option("--gains", arguments->gains,
                   "Torque of a current [N m/A] for each joint, in the order of the columns")
      ->delimiter(',');
  add_number(*command, "--load-mass", arguments->load_mass, kLoadMass,
             "Mass that LOG carries and --unloaded does not [kg]: finds the gains of currents")
      ->needs("--unloaded")
      ->excludes("--gains");
  command
      ->add_option(
          "--method", arguments->method,
          "regression; grid: also by trial, joint by joint on a grid and then all joints at "
          "once (paper A), to compare with")
      ->check(CLI::IsMember({"regression", "grid"}))
      ->capture_default_str();
  command->add_flag("--known-body", arguments->is_body_known,
                    "Fit friction alone: the inertias are the description's");
  command->add_flag("--skip-bad", arguments->skip_bad, "Skip bad rows");
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return run_robot(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
