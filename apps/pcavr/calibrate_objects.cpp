// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_objects.hpp"

#include <memory>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "calibrate_commands.hpp"
#include "calibration_outputs.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr InputRange kTouchingForce{"force", 1e-3, 1e5, "N",
                                    "from below any sensor's noise to the largest arms"};

struct CalibrateObjectsArguments {
  std::string recording;
  CalibrationOutputOption output;
  ObjectsInput objects;
};

nlohmann::ordered_json object_json(const CalibratedObject& object) {
  const Eigen::Vector3d& p = object.T_tracked_object.translation();
  const Eigen::Vector4d q = object.T_tracked_object.rotation().coeffs();
  nlohmann::ordered_json json{{"name", object.name},
                              {"position", {p.x(), p.y(), p.z()}},
                              {"rotation", {q[0], q[1], q[2], q[3]}},
                              {"scale", object.scale},
                              {"unit", object.mesh_unit}};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    nlohmann::ordered_json std = nullptr;
    if (object.is_observable[i]) std = object.stds[i];
    json["std"].push_back(std);
  }
  json["observable"] = parameter_names(object, true);
  json["not_observable"] = parameter_names(object, false);
  json["contacts"] = object.contacts;
  json["before_rms"] = object.before_rms;
  json["fitted_rms"] = object.fitted_rms;
  json["held_out_rms"] = object.held_out_rms;
  json["notes"] = object.notes;
  return json;
}

std::string object_summary(const CalibratedObject& object) {
  const Eigen::Vector3d p = 1e3 * object.T_tracked_object.translation();
  const Eigen::Vector4d q = object.T_tracked_object.rotation().coeffs();
  std::string text = fmt::format(
      "{}: mesh in the tracker's frame: x {:.1f}, y {:.1f}, z {:.1f} mm; q {:.5f} {:.5f} {:.5f} "
      "{:.5f} (x y z w)\n"
      "  {} contacts; tip to surface {} mm rms, {} mm as stated\n  observable: {}\n",
      object.name, p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3], object.contacts,
      readable(1e3 * object.fitted_rms), readable(1e3 * object.before_rms),
      parameter_names(object, true));
  const std::string kept = parameter_names(object, false);
  if (!kept.empty()) text += "  not observable, as stated: " + kept + '\n';
  return text;
}

Expected<CommandResult> run_objects(CalibrateObjectsArguments arguments, const Observer& observer) {
  Expected<CalibrationOutputs> outputs =
      CalibrationOutputs::create(arguments.output, {arguments.recording});
  if (!outputs) return outputs.error();
  arguments.objects.recording = arguments.recording;
  const Expected<TouchedObjects> touched = read_touched_objects(arguments.objects, observer);
  if (!touched) return touched.error();
  for (const std::string& note : touched->notes) observer.on_note(note);
  std::vector<CalibratedObject> found;
  CommandResult result;
  result.json = {{"calibration", arguments.output.file}};
  std::string verdict;
  for (const TouchedObject& object : touched->objects) {
    Expected<CalibratedObject> one = calibrate_object(object);
    if (!one) {
      Error error = one.error();
      error.file = arguments.recording;
      return error;
    }
    for (const std::string& note : one->notes) observer.on_warning(note);
    result.json["objects"].push_back(object_json(*one));
    result.summary += object_summary(*one);
    verdict += describe_object(*one) + '\n';
    found.push_back(*std::move(one));
  }
  result.summary += arguments.output.written_lines() + how_to_use(arguments.output.file) + verdict;
  const Expected<void> done = outputs->commit(
      format_objects(found, arguments.objects), [&](const std::filesystem::path& folder) {
        return write_objects_report(found, touched->objects, json_text(result.json, 2), folder);
      });
  if (!done) return done.error();
  return result;
}

}  // namespace

void add_calibrate_objects(CLI::App& calibrate, Action& action) {
  CLI::App* command = calibrate.add_subcommand(
      "objects", "Where tracked bodies' meshes are in the tracker's frames, from contacts");
  command->footer("Example:\n  pcavr calibrate objects my_recording -o objects.yaml");
  auto arguments = std::make_shared<CalibrateObjectsArguments>();
  command
      ->add_option("recording", arguments->recording,
                   "Recording in which the tip pushes tracked bodies, from all sides")
      ->required();
  add_calibration_output(*command, arguments->output);
  add_number(*command, "--min-force", arguments->objects.min_force, kTouchingForce,
             "Force from which on the tip touches [N]; default: by the largest force");
  command->add_flag("--skip-bad", arguments->objects.skip_bad, "Leave out rows that can't be read");
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_objects(*arguments, observer); };
  });
}

}  // namespace pcavr::app
