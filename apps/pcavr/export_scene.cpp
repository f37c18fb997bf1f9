// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "export_scene.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/physics/object/sample_parameters.hpp"
#include "pcavr/pipeline/known_parameters.hpp"
#include "pcavr/results/export/export_robot.hpp"
#include "pcavr/results/export/export_world.hpp"
#include "pcavr/results/export/plain_scene.hpp"
#include "pcavr/results/export/write_export.hpp"
#include "pcavr/robots/arm/identified_arm.hpp"
#include "pcavr/robots/robot/urdf.hpp"

namespace pcavr::app {
namespace {

struct Writer {
  const char* format;
  Expected<void> (*write)(ExportedWorld& world, const std::filesystem::path& folder);
};
constexpr std::array kWriters{Writer{"mjcf", &write_mjcf}, Writer{"urdf", &write_urdf},
                              Writer{"sdf", &write_sdf}, Writer{"usd", &write_usd},
                              Writer{kPlanningFormat, &write_moveit}};

/// An identified arm, and the description that it is written into.
struct RobotInput {
  ExportedRobot robot;
  std::string urdf;  ///< text
};

Expected<std::optional<RobotInput>> read_robot(const ExportArguments& arguments,
                                               const Observer& observer) {
  if (arguments.robot.empty()) return std::optional<RobotInput>();
  Expected<std::string> urdf = read_file(arguments.robot);
  if (!urdf) return urdf.error();
  const Expected<RobotModel> described = parse_urdf(*urdf, arguments.robot);
  if (!described) return described.error();
  const Expected<IdentifiedArm> identified = read_identified_arm(arguments.identified, *described);
  if (!identified) return identified.error();
  Expected<ExportedRobot> robot = make_exported_robot(*described, *identified);
  if (!robot) {
    Error error = robot.error();
    error.file = arguments.identified;
    return error;
  }
  for (const std::string& warning : robot->warnings) observer.on_warning(warning);
  return std::optional(RobotInput{.robot = *std::move(robot), .urdf = *std::move(urdf)});
}

/// Writes the arm's files, and adds its numbers and residuals to the world's.
Expected<void> write_robot(const RobotInput& input, const std::filesystem::path& folder,
                           ExportedWorld& world) {
  const auto& [robot, urdf] = input;
  if (auto written = write_robot_urdf(robot, urdf, folder); !written) return written;
  if (auto written = write_robot_mjcf(robot, folder); !written) return written;
  world.numbers.insert(world.numbers.end(), robot.numbers.begin(), robot.numbers.end());
  world.residuals.insert(world.residuals.end(), robot.residuals.begin(), robot.residuals.end());
  world.warnings.insert(world.warnings.end(), robot.warnings.begin(), robot.warnings.end());
  return {};
}

/// Reads the motion to be exported, and sets where the tool starts and the radius of its tip.
Expected<Trajectory> use_motion(const ExportArguments& arguments,
                                const Configuration& configuration, const Observer& observer,
                                ExportOptions& options) {
  if (arguments.motion.empty()) return Trajectory();
  const Expected<Recording> recording =
      read_with_warnings(arguments.motion, false, configuration, observer);
  if (!recording) return recording.error();
  if (recording->tool.empty()) {
    return Error{.message = "the recording has no tool motion",
                 .file = arguments.motion,
                 .hint = "give one with a tool.csv, or omit --motion"};
  }
  options.T_base_tool = recording->tool.poses().front().pose;
  if (!options.tool_radius) options.tool_radius = recording->manifest.tool_radius;
  return recording->tool;
}

/// Writes the world, its numbers, the arm and the tool's motion into a folder that exists.
Expected<void> write_world(const ExportArguments& arguments, const ParameterTable& parameters,
                           const Trajectory& motion, const std::optional<RobotInput>& robot,
                           const std::filesystem::path& folder, ExportedWorld& world) {
  const auto writer = std::find_if(kWriters.begin(), kWriters.end(), [&](const Writer& one) {
    return arguments.format == one.format;
  });
  if (auto written = writer->write(world, folder); !written) return written;
  if (!motion.empty()) {
    if (auto written = write_motion(motion, folder); !written) return written;
    if (arguments.format == "mjcf") {
      if (auto written = write_mujoco_runners(folder); !written) return written;
    }
  }
  if (robot) {
    if (auto written = write_robot(*robot, folder, world); !written) return written;
  }
  return write_export_manifest(world, parameters, arguments.format, folder);
}

/// "007" of 120, "7" of 9: names that sort by number.
std::string sample_name(std::size_t number, std::size_t count) {
  return fmt::format("{:0{}}", number, std::to_string(count).size());
}

/// Writes samples/NUMBER, each a world of parameters drawn from their distribution, and
/// samples.csv with what was drawn.
Expected<void> write_samples(const ExportArguments& arguments, const SceneManifest& scene,
                             const ParameterTable& parameters, const ExportOptions& options,
                             const Trajectory& motion, const std::filesystem::path& folder,
                             const Observer& observer) {
  std::string table = "sample,object,parameter,value\n";
  for (std::size_t number = 1; number <= arguments.samples; ++number) {
    Random random = Random(arguments.seed).fork(number);
    ParameterTable drawn;
    const std::string name = sample_name(number, arguments.samples);
    for (const auto& [object, known] : parameters) {
      drawn[object] = sample_parameters(known, random);
      for (const auto& [key, value] : list_parameters(drawn[object])) {
        table += fmt::format("{},{},{},{:.9g}\n", name, object, key, value.value);
      }
    }
    Expected<ExportedWorld> world = make_exported_world(scene, drawn, options);
    if (!world) return world.error();
    const std::filesystem::path place = folder / "samples" / name;
    std::error_code code;
    std::filesystem::create_directories(place, code);
    if (code) return Error{.message = code.message(), .file = place.string()};
    if (auto written = write_world(arguments, drawn, motion, std::nullopt, place, *world);
        !written) {
      return written;
    }
    observer.on_progress("samples", number, arguments.samples);
  }
  return write_file(folder / "samples.csv", table);
}

Expected<ParameterTable> table_of(const ExportArguments& arguments, const SceneManifest& scene) {
  std::optional<ParameterTable> given;
  if (!arguments.parameters.empty()) {
    Expected<ParameterTable> table = read_parameters(arguments.parameters);
    if (!table) return table.error();
    given = std::move(*table);
  }
  return known_parameters(scene, given, arguments.parameters);
}

CommandResult describe(const ExportedWorld& world, const ExportArguments& arguments) {
  CommandResult result;
  result.json = {{"output", arguments.output}, {"format", arguments.format}};
  result.json["residuals"] = nlohmann::ordered_json::array();
  for (const ExportResidual& residual : world.residuals) {
    result.summary += fmt::format("{:<12} {:<42} {:>10.4g} {:<4} {:>+7.2f} %  {}\n",
                                  residual.object, residual.what, residual.wanted, residual.unit,
                                  100.0 * residual.relative(), residual.remark);
    result.json["residuals"].push_back(
        {{"object", residual.object}, {"what", residual.what}, {"relative", residual.relative()}});
  }
  if (arguments.samples > 0) {
    result.summary +=
        fmt::format("{} worlds drawn from the parameters' distribution\n", arguments.samples);
    result.json["samples"] = arguments.samples;
  }
  if (!world.bodies.empty() && arguments.format != kPlanningFormat) {
    result.summary += fmt::format("friction holds at {:.4g} m/s\n", world.reference_speed);
  }
  result.summary += fmt::format("wrote {}\n", arguments.output);
  return result;
}

/// The arm alone, without a scene.
Expected<CommandResult> export_robot(const ExportArguments& arguments, const RobotInput& robot,
                                     OutputFolder& folder) {
  ExportedWorld nothing;
  if (auto written = write_robot(robot, folder.path(), nothing); !written) return written.error();
  if (auto written = write_export_manifest(nothing, {}, arguments.format, folder.path());
      !written) {
    return written.error();
  }
  if (auto committed = folder.commit(); !committed) return committed.error();
  return describe(nothing, arguments);
}

Expected<CommandResult> export_plain(const ExportArguments& arguments, PlainFormat format,
                                     const SceneManifest& scene, OutputFolder& folder) {
  const Expected<PlainScene> written = write_plain_scene(scene, format, folder.path());
  if (!written) return written.error();
  if (auto committed = folder.commit(); !committed) return committed.error();
  const char* what = format == PlainFormat::pcd ? "points" : "triangles";
  CommandResult result;
  result.summary =
      fmt::format("{}: {} {}\nwrote {}\n", written->file, written->count, what, arguments.output);
  result.json = {{"output", arguments.output},
                 {"format", arguments.format},
                 {"file", written->file},
                 {what, written->count}};
  return result;
}

Expected<CommandResult> export_world(const ExportArguments& arguments, const SceneManifest& scene,
                                     const std::optional<RobotInput>& robot,
                                     const Configuration& configuration, const Observer& observer,
                                     OutputFolder& folder) {
  const Expected<ParameterTable> parameters = table_of(arguments, scene);
  if (!parameters) return parameters.error();
  ExportOptions options;
  options.assumes = arguments.assumes;
  options.geometry_only = arguments.format == kPlanningFormat;
  options.speed = arguments.speed;
  options.tool_radius = arguments.tool_radius;
  const Expected<Trajectory> motion = use_motion(arguments, configuration, observer, options);
  if (!motion) return motion.error();
  Expected<ExportedWorld> world = make_exported_world(scene, *parameters, options);
  if (!world) return world.error();
  for (const std::string& warning : world->warnings) observer.on_warning(warning);
  const std::filesystem::path& place = folder.path();
  if (auto written = write_world(arguments, *parameters, *motion, robot, place, *world); !written) {
    return written.error();
  }
  if (arguments.samples > 0) {
    // Of one speed, whatever is drawn: else the samples' coefficients hold at different ones.
    options.speed = world->reference_speed;
    options.scan_base = &world->scan_base;
    if (auto written =
            write_samples(arguments, scene, *parameters, options, *motion, place, observer);
        !written) {
      return written.error();
    }
  }
  if (auto committed = folder.commit(); !committed) return committed.error();
  return describe(*world, arguments);
}

}  // namespace

std::vector<std::string> world_formats() {
  std::vector<std::string> names;
  for (const Writer& writer : kWriters) names.emplace_back(writer.format);
  return names;
}

Expected<CommandResult> export_scene(const ExportArguments& arguments,
                                     const Configuration& configuration, const Observer& observer) {
  std::vector<std::filesystem::path> inputs;
  for (const std::string& input : {arguments.scene, arguments.parameters, arguments.motion,
                                   arguments.robot, arguments.identified}) {
    if (!input.empty()) inputs.emplace_back(input);
  }
  const Expected<void> apart = check_outputs({arguments.output}, inputs);
  if (!apart) return apart.error();
  Expected<OutputFolder> folder = OutputFolder::create(arguments.output);
  if (!folder) {
    Error error = folder.error();
    error.hint = "choose a new or an empty folder that you may write to";
    return error;
  }
  const Expected<std::optional<RobotInput>> robot = read_robot(arguments, observer);
  if (!robot) return robot.error();
  if (arguments.scene.empty()) return export_robot(arguments, **robot, *folder);
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  if (const std::optional<PlainFormat> plain = plain_format_of(arguments.format)) {
    return export_plain(arguments, *plain, *scene, *folder);
  }
  return export_world(arguments, *scene, *robot, configuration, observer, *folder);
}

}  // namespace pcavr::app
