// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "pcavr/results/export/plain_scene.hpp"

#include "commands.hpp"
#include "export_lerobot.hpp"
#include "export_scene.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr std::size_t kMaxSamples = 1000;  ///< each is a folder with its meshes
constexpr InputRange kSpeed{"speed", 0.0, 10.0, "m/s", "faster than any arm pushes"};

constexpr int kMaxRate = 1000;  ///< [1/s] no recorded stream is faster

struct ExportCommandLine {
  std::vector<std::string> inputs;  ///< a scene; for lerobot recordings
  ExportArguments scene;
  LerobotArguments lerobot;  ///< its own options
};

std::vector<std::string> format_names() {
  std::vector<std::string> names = world_formats();
  for (const auto& [name, format] : kPlainFormats) names.emplace_back(name);
  names.emplace_back(kLerobotFormat);
  return names;
}

/// Throws CLI::ParseError where options do not belong together.
void check_lerobot(const ExportCommandLine& line) {
  const ExportArguments& arguments = line.scene;
  const LerobotArguments& lerobot = line.lerobot;
  if (arguments.format != kLerobotFormat) {
    if (!lerobot.scenes.empty() || lerobot.options.rate || !lerobot.options.task.empty())
      throw CLI::ValidationError("--to", "--scene, --fps and --task are for lerobot only");
    if (line.inputs.size() > 1)
      throw CLI::ValidationError("scene", arguments.format + " takes one scene");
    return;
  }
  if (line.inputs.empty()) throw CLI::RequiredError("a recording");
  if (!arguments.motion.empty() || !arguments.robot.empty() || arguments.samples > 0 ||
      arguments.speed || arguments.tool_radius || arguments.assumes) {
    throw CLI::ValidationError(
        "--to", "lerobot takes recordings, --parameters, --scene, --fps, --task and -o only");
  }
}

/// The same of the other formats.
void check_combination(const ExportArguments& arguments) {
  if (arguments.scene.empty() && arguments.robot.empty()) {
    throw CLI::RequiredError("scene or --robot");
  }
  const std::string& format = arguments.format;
  if (arguments.scene.empty() && format != "mjcf" && format != "urdf") {
    throw CLI::ValidationError("--to", "an arm without a scene is written as mjcf or urdf");
  }
  const bool has_motion = !arguments.motion.empty() || arguments.samples > 0 || arguments.speed ||
                          arguments.tool_radius;
  const bool has_friction = !arguments.parameters.empty() || arguments.assumes;
  if (arguments.scene.empty() && (has_motion || has_friction)) {
    throw CLI::ValidationError(
        "scene", "is missing: an arm alone takes --robot, --identified, --to and -o only");
  }
  if (format == kPlanningFormat && has_motion) {
    throw CLI::ValidationError("--to", format +
                                           " has neither friction nor motion: leave out "
                                           "--motion, --sample, --speed and --tool-radius");
  }
  if (!plain_format_of(format)) return;
  if (has_motion || has_friction || !arguments.robot.empty()) {
    throw CLI::ValidationError("--to", format + " has geometry alone: give scene and -o only");
  }
}

void add_arm_options(CLI::App& command, ExportArguments& arguments) {
  CLI::Option* robot = command.add_option(
      "--robot", arguments.robot,
      "Description (URDF) of an arm, written with its identified bodies and joint friction: "
      "robot.urdf, robot.xml (MJCF)");
  command
      .add_option("--identified", arguments.identified,
                  "Report of pcavr identify robot for this arm")
      ->needs(robot);
  robot->needs("--identified");
}

/// Of what moves in the world, and how.
void add_motion_options(CLI::App& command, ExportArguments& arguments) {
  command.add_option(
      "--motion", arguments.motion,
      "Recording whose tool's motion is written, with a script that plays it in MuJoCo");
  command.add_flag("--assume", arguments.assumes,
                   "Take defaults for masses and friction that were not identified");
  add_number(command, "--speed", arguments.speed, kSpeed,
             "Speed at which the bodies will slide [m/s]: the exported coefficients hold there; by "
             "default the mean speed of the identification");
  command
      .add_option("--sample", arguments.samples,
                  "Also write this many worlds, of parameters drawn from their identified "
                  "distribution: samples/, samples.csv")
      ->check(CLI::Range(std::size_t{1}, kMaxSamples));
  command.add_option("--seed", arguments.seed, "Of the samples")->capture_default_str();
  add_number(command, "--tool-radius", arguments.tool_radius, ranges::kToolRadius,
             "Radius of the tool's spherical tip [m]");
}

void add_lerobot_options(CLI::App& command, LerobotArguments& lerobot) {
  command
      .add_option("--scene", lerobot.scenes,
                  "Of recordings with images, for lerobot: the scene of all, or one for each")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--fps", lerobot.options.rate,
                  fmt::format("Frames a second, for lerobot; by default the images' rate, or {}",
                              kDefaultLerobotRate))
      ->check(CLI::Range(1, kMaxRate));
  command.add_option("--task", lerobot.options.task,
                     "What is done, in words, for lerobot; by default: push NAME");
}

}  // namespace

void add_export(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command =
      app.add_subcommand("export",
                         "Write a scene with identified friction for a physics engine, a planner "
                         "or, as geometry alone, a viewer; or recordings as a data set");
  command->footer(
      "Examples:\n  pcavr export my_scene --parameters parameters.yaml --to mjcf -o my_world\n"
      "  pcavr export --robot arm.urdf --identified arm_report --to urdf -o my_arm\n"
      "  pcavr export my_scene --to obj -o my_mesh\n"
      "  pcavr export my_recording --to lerobot -o my_dataset");
  auto line = std::make_shared<ExportCommandLine>();
  ExportArguments& arguments = line->scene;
  command->add_option(
      "scene", line->inputs,
      "Scene from pcavr build; for lerobot recordings, or a folder or list of them");
  command->add_option("--parameters", arguments.parameters,
                      "Parameter file from pcavr identify, of this scene");
  command
      ->add_option("--to", arguments.format,
                   "Format: a world for an engine, a planning scene (moveit), geometry alone (gltf "
                   "to 3dtiles), or a data set for policies (lerobot)")
      ->required()
      ->check(CLI::IsMember(format_names()));
  add_arm_options(*command, arguments);
  add_motion_options(*command, arguments);
  add_lerobot_options(*command, line->lerobot);
  command
      ->add_option("-o,--output", arguments.output,
                   "Folder for what is exported: a new or an empty one")
      ->required();
  command->callback([line, &configuration, &action] {
    check_lerobot(*line);
    ExportArguments& scene = line->scene;
    if (scene.format == kLerobotFormat) {
      action = [line, &configuration](const Observer& observer) {
        LerobotArguments& lerobot = line->lerobot;
        lerobot.recordings = line->inputs;
        lerobot.parameters = line->scene.parameters;
        lerobot.output = line->scene.output;
        return export_lerobot(lerobot, configuration, observer);
      };
      return;
    }
    if (!line->inputs.empty()) scene.scene = line->inputs.front();
    check_combination(scene);
    action = [line, &configuration](const Observer& observer) {
      return export_scene(line->scene, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
