// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "pcavr/recording/camera_file.hpp"

#include "commands.hpp"
#include "output_option.hpp"

namespace pcavr::app {
namespace {

struct SimulateArguments {
  std::string name;
  OutputOption output;
  std::uint64_t seed = 1;
  int threads = 1;
  bool without_images = false;
  bool without_mass = false;
  SensorFaults faults;
  double saturation = 0.0;
  std::string lost;
  std::string camera;
};

/// "A:B", seconds.
std::optional<SensorFaults::Gap> gap_of(const std::string& text) {
  SensorFaults::Gap gap;
  char more = 0;
  const int read = std::sscanf(text.c_str(), "%lf:%lf%c", &gap.begin, &gap.end, &more);
  if (read != 2 || !(gap.begin >= 0.0 && gap.end > gap.begin)) return std::nullopt;
  return gap;
}

/// The case asked for, with what the options change in it.
SimulationCase changed(SimulationCase simulation, const SimulateArguments& arguments) {
  simulation.with_images = !arguments.without_images;
  simulation.with_mass = !arguments.without_mass;
  simulation.faults = arguments.faults;
  if (arguments.saturation > 0.0) simulation.faults.saturation = arguments.saturation;
  simulation.faults.lost_tracking = gap_of(arguments.lost);
  return simulation;
}

Expected<CommandResult> run_simulation(const SimulateArguments& arguments,
                                       const Observer& observer) {
  const std::vector<SimulationCase>& cases = simulation_cases();
  const auto known = std::find_if(cases.begin(), cases.end(), [&](const SimulationCase& one) {
    return one.name == arguments.name;
  });
  SimulationCase chosen = changed(*known, arguments);
  if (!arguments.camera.empty()) {
    const Expected<CameraFile> sensor = read_camera_file(arguments.camera);
    if (!sensor) return sensor.error();
    if (sensor->camera.width < 8 || sensor->camera.height < 8) {
      return Error{.message = "an image of less than 8 x 8 pixels shows nothing",
                   .file = arguments.camera,
                   .hint = "give a camera with larger images"};
    }
    chosen.camera = sensor->camera;
  }
  if (!chosen.with_images && chosen.task == ToolTask::none) {
    return Error{.message = "without images the case '" + chosen.name + "' records nothing",
                 .hint = "leave out --no-images, or choose a case with a tool"};
  }
  Expected<OutputFolder> folder =
      create_output(arguments.output, OutputKind::recording, {arguments.camera});
  if (!folder) return folder.error();
  const Expected<void> done =
      simulate(chosen, arguments.seed, folder->path(), {arguments.threads}, observer);
  if (!done) return done.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return CommandResult{.summary = "next: pcavr build " + arguments.output.folder + " -o SCENE\n",
                       .json = {{"recording", arguments.output.folder},
                                {"case", arguments.name},
                                {"seed", arguments.seed}}};
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "simulate", "Make a recording with exact truth: ray-cast images, tool, force");
  std::string footer = "Cases:\n";
  std::vector<std::string> names;
  for (const SimulationCase& known : simulation_cases()) {
    names.push_back(known.name);
    footer += "  " + known.name + ": " + known.description + '\n';
  }
  command->footer(footer + "\nExample:\n  pcavr simulate " + names.front() +
                  " -o my_recording --seed 7");
  auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("case", arguments->name, "What to simulate")
      ->required()
      ->check(CLI::IsMember(names));
  add_output_option(*command, arguments->output, "Folder for the recording");
  command->add_option("--seed", arguments->seed, "The same seed gives the same bytes")
      ->capture_default_str();
  command->add_flag("--no-images", arguments->without_images,
                    "No frames: the objects' start is in the manifest, and tracked/ holds what a "
                    "marker tracker would have found");
  command->add_flag("--without-mass", arguments->without_mass, "No masses in the manifest");
  command
      ->add_option("--clock-offset", arguments->faults.clock_offset,
                   "The wrench's stamps are late by this [s]; early where negative")
      ->check(CLI::Range(-10.0, 10.0));
  command->add_flag("--flip-force", arguments->faults.is_force_flipped,
                    "The wrench has the wrong sign");
  command->add_option("--saturate", arguments->saturation, "The force sensor's end of range [N]")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--lose-tracking", arguments->lost,
                   "No object is seen between these times, A:B [s]")
      ->needs("--no-images")
      ->check([](const std::string& text) {
        return gap_of(text) ? std::string() : "give two times in seconds, as 2.5:3.5";
      });
  command->add_option("--camera", arguments->camera,
                      "Camera file: image size, intrinsics and lens (see calib/cameras)");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_simulation(*arguments, observer); };
  });
}

}  // namespace pcavr::app
