// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_force.hpp"

#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "calibrate_commands.hpp"
#include "calibration_outputs.hpp"

namespace pcavr::app {
namespace {

struct CalibrateForceArguments {
  std::string poses, forces, up = "z";
  CalibrationOutputOption output;
  PoseListOptions reading;
};

nlohmann::ordered_json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json force_json(const ForceSensorResult& found) {
  const Eigen::Vector4d q = found.R_sensor_flange.coeffs();
  nlohmann::ordered_json json{{"axes", found.axes == ForceAxes::sensor ? "sensor" : "base"},
                              {"is_pose_inverted", found.is_pose_inverted},
                              {"sign", found.sign},
                              {"text", describe_force_axes(found)},
                              {"rotation", {q[0], q[1], q[2], q[3]}},
                              {"rotation_std", vector_json(found.rotation_std)},
                              {"mass", found.mass},
                              {"mass_std", found.mass_std},
                              {"force_bias", vector_json(found.force_bias)},
                              {"force_bias_std", vector_json(found.force_bias_std)}};
  if (found.centre) {
    json["centre"] = vector_json(*found.centre);
    json["centre_std"] = vector_json(found.centre_std);
    json["torque_bias"] = vector_json(found.torque_bias);
    json["torque_bias_std"] = vector_json(found.torque_bias_std);
    json["torque_rms"] = found.torque_rms;
  }
  for (int row = 0; row < 3; ++row) {
    json["gain"].push_back(vector_json(found.gain.row(row).transpose()));
    json["gain_std"].push_back(vector_json(found.gain_std.row(row).transpose()));
  }
  json["has_cross_talk"] = found.has_cross_talk;
  json["residual_rms"] = found.residual_rms;
  json["held_out_rms"] = found.held_out_rms;
  json["other_axes_rms"] = found.other_axes_rms;
  json["outliers"] = nlohmann::ordered_json::array();
  for (const ForceResidual& residual : found.residuals) {
    if (residual.is_outlier) json["outliers"].push_back(residual.name);
  }
  json["notes"] = found.notes;
  return json;
}

std::string vector_line(const char* name, const Eigen::Vector3d& value, const Eigen::Vector3d& std,
                        double factor, const char* unit) {
  std::string text = name;
  for (int axis = 0; axis < 3; ++axis) {
    const UncertainText one = uncertain(factor * value[axis], factor * std[axis]);
    text += std::string(axis > 0 ? ", " : " ") + "xyz"[axis] + ' ' + one.value + " +- " + one.std;
  }
  return text + ' ' + unit + '\n';
}

std::string force_summary(const ForceSensorResult& found) {
  const UncertainText mass = uncertain(found.mass, found.mass_std);
  std::string text = fmt::format("load: {} +- {} kg\n", mass.value, mass.std);
  if (found.centre) {
    text += vector_line("load's centre in the sensor:", *found.centre, found.centre_std, 1e3, "mm");
    text += vector_line("torque at no load:", found.torque_bias, found.torque_bias_std, 1.0, "N m");
  }
  text += vector_line("force at no load:", found.force_bias, found.force_bias_std, 1.0, "N");
  text += fmt::format(
      "force: rms per axis {} N fitted, {} N each pose by the others; {} N if the readings were in "
      "the {}'s axes\n",
      readable(found.residual_rms), readable(found.held_out_rms), readable(found.other_axes_rms),
      found.axes == ForceAxes::sensor ? "base" : "sensor");
  text += found.has_cross_talk ? "gains or cross-talk: readings over forces (%)\n"
                               : "gains and cross-talk: none beyond the noise\n";
  for (int row = 0; row < 3 && found.has_cross_talk; ++row) {
    text += fmt::format("  {:8.2f} {:8.2f} {:8.2f}\n", 100.0 * found.gain(row, 0),
                        100.0 * found.gain(row, 1), 100.0 * found.gain(row, 2));
  }
  return text;
}

Expected<CommandResult> run_force(const CalibrateForceArguments& arguments,
                                  const Observer& observer) {
  Expected<CalibrationOutputs> outputs =
      CalibrationOutputs::create(arguments.output, {arguments.poses, arguments.forces});
  if (!outputs) return outputs.error();
  const ForceInput input{arguments.poses, arguments.forces, arguments.reading};
  const Expected<ForceReadings> readings = read_force_readings(input);
  if (!readings) return readings.error();
  for (const std::string& note : readings->notes) observer.on_note(note);
  ForceSensorOptions options;
  options.up_base = Eigen::Vector3d::Unit(arguments.up[0] - 'x');
  const Expected<ForceSensorResult> found = calibrate_force_sensor(readings->readings, options);
  if (!found) {
    Error error = found.error();
    error.file = arguments.forces.empty() ? arguments.poses : arguments.forces;
    return error;
  }
  for (const std::string& note : found->notes) observer.on_warning(note);
  CommandResult result;
  result.json = {{"calibration", arguments.output.file},
                 {"format", readings->format},
                 {"poses", readings->readings.size()}};
  result.json.update(force_json(*found));
  result.summary = "input: " + readings->format + '\n' + force_summary(*found) +
                   arguments.output.written_lines() + "the readings are " +
                   describe_force_axes(*found) + '\n';
  const Expected<void> done =
      outputs->commit(format_force_sensor(*found, input), [&](const std::filesystem::path& folder) {
        return write_force_report(*found, *readings, json_text(result.json, 2), folder);
      });
  if (!done) return done.error();
  return result;
}

}  // namespace

void add_calibrate_force(CLI::App& calibrate, Action& action) {
  CLI::App* command = calibrate.add_subcommand(
      "force", "Bias, load, turn, sign and axes of a force sensor, from poses at rest");
  command->footer("Example:\n  pcavr calibrate force poses_and_forces.csv -o force.yaml");
  auto arguments = std::make_shared<CalibrateForceArguments>();
  command
      ->add_option("poses", arguments->poses,
                   "Table of the flange's poses in the base, with fx, fy, fz where they are in one")
      ->required();
  command->add_option("forces", arguments->forces,
                      "Table of forces with stamps, where they are in a file of their own");
  add_calibration_output(*command, arguments->output);
  command->add_option("--up", arguments->up, "Axis of the base that points up")
      ->check(CLI::IsMember({"x", "y", "z"}))
      ->capture_default_str();
  command->add_flag("--w-first", arguments->reading.is_w_first, "Quaternions are w x y z");
  command->add_flag("--skip-bad", arguments->reading.skip_bad, "Leave out rows that can't be read");
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_force(*arguments, observer); };
  });
}

}  // namespace pcavr::app
