// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/plant_robot.hpp"
#include "pcavr/pipeline/plugin_robot.hpp"
#include "pcavr/pipeline/recorded_pictures.hpp"
#include "pcavr/pipeline/recorded_robot.hpp"
#include "pcavr/pipeline/teleop_input.hpp"
#include "pcavr/simulation/simulate.hpp"
#include "pcavr/teleoperation/ros2/ros2_robot.hpp"

#include "commands.hpp"
#include "link_arguments.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

struct RobotSiteArguments {
  SiteArguments site;
  std::string authorized;
  std::string plant;   ///< a case of pcavr simulate
  std::string ros2;    ///< a setup of ROS 2 topics
  std::string truth;   ///< folder for what the plant did
  std::string plugin;  ///< FILE.so or FILE.so,OPTIONS
  std::uint64_t seed = 1;
  bool without_corrections = false;
  bool as_json = false;
};

Expected<LinkServer> open_server(const RobotSiteArguments& arguments) {
  Expected<std::optional<LinkKeys>> keys = keys_of(arguments.site);
  if (!keys) return keys.error();
  if (keys->has_value() == arguments.authorized.empty()) {
    return Error{.message = "--key and --authorized must be given together"};
  }
  if (*keys && !std::filesystem::is_directory(arguments.authorized)) {
    return Error{.message = "is not a folder",
                 .file = arguments.authorized,
                 .hint = "put the .pub files of the operators' sites into it"};
  }
  return LinkServer::open({.host = arguments.site.host,
                           .port = arguments.site.port,
                           .keys = std::move(*keys),
                           .authorized = arguments.authorized});
}

CommandResult describe_robot_site(const RobotSiteReport& report) {
  CommandResult result;
  const double cycles = static_cast<double>(std::max<std::size_t>(report.cycles, 1));
  result.summary = fmt::format(
      "sessions {}, holds {}, emergency stops {}\ncommands {}, {} discarded\ncorrections {}, {} "
      "bytes of {} that "
      "streaming would send, {} sent again\npictures {}, {:.1f} kB each\ncycles {}, {} late, "
      "{:.1f} us CPU each, {:.2f} ms at "
      "most\n",
      report.sessions, report.holds, report.emergency_stops, report.commands,
      report.discarded_commands, report.corrections.size(), report.correction_bytes,
      report.streaming_bytes, report.repeated_corrections, report.pictures,
      1e-3 * static_cast<double>(report.picture_bytes) /
          static_cast<double>(std::max<std::size_t>(report.pictures, 1)),
      report.cycles, report.late_cycles, 1e6 * report.cpu / cycles,
      1e3 * report.max_correction_time);
  if (report.tool_response) {
    result.summary +=
        fmt::format("the arm gives way by {:.4f} mm/N at the tip: the operator's world does, too\n",
                    1e3 * report.tool_response->compliance);
  }
  for (const std::string& note : report.notes) result.summary += "  note: " + note + '\n';
  result.json = {{"sessions", report.sessions},
                 {"holds", report.holds},
                 {"emergency_stops", report.emergency_stops},
                 {"commands", report.commands},
                 {"discarded_commands", report.discarded_commands},
                 {"invalid_messages", report.invalid_messages},
                 {"repeated_corrections", report.repeated_corrections},
                 {"correction_bytes", report.correction_bytes},
                 {"streaming_bytes", report.streaming_bytes},
                 {"pictures", report.pictures},
                 {"picture_bytes", report.picture_bytes},
                 {"cycles", report.cycles},
                 {"late_cycles", report.late_cycles},
                 {"cpu_s", report.cpu},
                 {"max_correction_cpu_s", report.max_correction_time},
                 {"notes", report.notes}};
  if (report.tool_response) {
    result.json["tool_compliance_m_per_n"] = report.tool_response->compliance;
    result.json["tool_rate_rad_s"] = report.tool_response->rate;
    result.json["tool_damping_ratio"] = report.tool_response->damping_ratio;
    result.json["tool_lag_s"] = report.tool_response->lag;
    result.json["tool_acceleration_lag_s2"] = report.tool_response->acceleration_lag;
  }
  result.json["corrections"] = nlohmann::ordered_json::array();
  for (const SentCorrection& sent : report.corrections) {
    result.json["corrections"].push_back({{"t", sent.t},
                                          {"object", sent.object},
                                          {"case", std::string(name_of(sent.which))},
                                          {"what", sent.what},
                                          {"bytes", sent.bytes}});
  }
  return result;
}

void announce(const LinkServer& server, const RobotInterface& robot,
              const RobotSiteArguments& arguments) {
  if (arguments.as_json) {
    std::cout << json_text(nlohmann::ordered_json{{"port", server.port()}, {"robot", robot.name()}})
              << '\n';
  } else {
    std::cout << fmt::format(
        "robot's site ({}) on {}:{}, {}; Ctrl+C ends it\n", robot.name(), arguments.site.host,
        server.port(), arguments.site.key.empty() ? "without keys, loopback only" : "with keys");
  }
  std::cout << std::flush;
}

/// The robot, and the world that it and the site know. The input must not move: the robot refers
/// to it.
struct RobotSource {
  std::unique_ptr<TeleopInput> input;
  std::unique_ptr<RobotInterface> robot;
  const PlantRobot* plant = nullptr;       ///< the robot, if its truth is kept
  std::optional<OutputFolder> truth = {};  ///< of the plant
  std::string publishes_by = {};           ///< file of topics for what is predicted; empty: none
};

Expected<RobotSource> read_recorded(const RobotSiteArguments& arguments, const SceneManifest& scene,
                                    const ReplayOptions& options,
                                    const Configuration& configuration, const Observer& observer) {
  const Expected<Recording> recording =
      read_with_warnings(arguments.site.recording, false, configuration, observer);
  if (!recording) return recording.error();
  Expected<TeleopInput> recorded = read_teleop_input(*recording, scene, options, observer);
  if (!recorded) return recorded.error();
  if (recorded->t_tool.size() < 2) {
    return Error{.message = "the recording has no motion of the tool",
                 .file = arguments.site.recording};
  }
  auto input = std::make_unique<TeleopInput>(std::move(*recorded));
  auto robot = make_recorded_robot(*input, options.teleop.pose.tracking_latency,
                                   make_recorded_pictures(*recording));
  return RobotSource{std::move(input), std::move(robot)};
}

/// A robot behind topics of ROS 2.
Expected<RobotSource> connect_ros2(const RobotSiteArguments& arguments, const SceneManifest& scene,
                                   const ReplayOptions& options, const Observer& observer) {
  const Expected<Ros2Setup> setup = read_ros2_setup(arguments.ros2);
  if (!setup) return setup.error();
  Expected<TeleopInput> world = read_teleop_world(scene, options, observer);
  if (!world) return world.error();
  auto input = std::make_unique<TeleopInput>(std::move(*world));
  Expected<std::unique_ptr<RobotInterface>> robot = make_ros2_robot(*setup, *input);
  if (!robot) {
    Error error = robot.error();
    if (error.file.empty()) error.file = arguments.ros2;
    return error;
  }
  RobotSource source{std::move(input), std::move(*robot)};
  if (setup->publication && arguments.site.publish.empty()) source.publishes_by = arguments.ros2;
  return source;
}

/// A robot behind a vendor's controller.
Expected<RobotSource> load_plugin(const RobotSiteArguments& arguments, const SceneManifest& scene,
                                  const ReplayOptions& options, const Observer& observer) {
  Expected<TeleopInput> world = read_teleop_world(scene, options, observer);
  if (!world) return world.error();
  auto input = std::make_unique<TeleopInput>(std::move(*world));
  const std::size_t comma = arguments.plugin.find(',');
  PluginRobotOptions plugin;
  if (comma != std::string::npos) plugin.text = arguments.plugin.substr(comma + 1);
  for (const TeleopObject& object : input->objects) plugin.objects.push_back(object.name);
  Expected<std::unique_ptr<RobotInterface>> robot =
      make_plugin_robot(arguments.plugin.substr(0, comma), plugin);
  if (!robot) return robot.error();
  return RobotSource{std::move(input), std::move(*robot)};
}

/// The simulated plant of a case.
Expected<RobotSource> simulate_robot(const RobotSiteArguments& arguments,
                                     const SceneManifest& scene, const ReplayOptions& options,
                                     const Observer& observer) {
  const std::vector<SimulationCase>& cases = simulation_cases();
  const auto chosen = std::find_if(cases.begin(), cases.end(), [&](const SimulationCase& one) {
    return one.name == arguments.plant && one.task != ToolTask::none;
  });
  if (chosen == cases.end()) {
    return Error{.message = arguments.plant.empty()
                                ? "a robot is missing: --ros2, --plugin, --plant or --recording"
                                : arguments.plant + " is not a case with a tool",
                 .hint = "give --plant push, or another case of pcavr simulate with a tool"};
  }
  Expected<TeleopInput> world = read_teleop_world(scene, options, observer);
  if (!world) return world.error();
  auto input = std::make_unique<TeleopInput>(std::move(*world));
  Expected<std::unique_ptr<PlantRobot>> robot = make_plant_robot(
      chosen->task, arguments.seed, *input, options.teleop.pose.tracking_latency, &*chosen);
  if (!robot) return robot.error();
  if (arguments.truth.empty()) return RobotSource{std::move(input), std::move(*robot)};
  Expected<OutputFolder> truth = OutputFolder::create(arguments.truth);
  if (!truth) return truth.error();
  (*robot)->keep_truth();
  const PlantRobot* const plant = robot->get();
  return RobotSource{std::move(input), std::move(*robot), plant, *std::move(truth)};
}

Expected<RobotSource> read_robot(const RobotSiteArguments& arguments, const SceneManifest& scene,
                                 const ReplayOptions& options, const Configuration& configuration,
                                 const Observer& observer) {
  if (!arguments.site.recording.empty()) {
    return read_recorded(arguments, scene, options, configuration, observer);
  }
  if (!arguments.ros2.empty()) return connect_ros2(arguments, scene, options, observer);
  if (!arguments.plugin.empty()) return load_plugin(arguments, scene, options, observer);
  return simulate_robot(arguments, scene, options, observer);
}

Expected<CommandResult> robot_site(const RobotSiteArguments& arguments,
                                   const Configuration& configuration, const Observer& observer) {
  Expected<LinkServer> server = open_server(arguments);
  if (!server) return server.error();
  Expected<ReplayOptions> options = site_options(arguments.site, configuration);
  if (!options) return options.error();
  if (arguments.without_corrections) options->teleop.with_corrections = false;
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.site.scene);
  if (!scene) return scene.error();
  Expected<RobotSource> source = read_robot(arguments, *scene, *options, configuration, observer);
  if (!source) return source.error();
  const TeleopInput& input = *source->input;
  RobotInterface* const robot = source->robot.get();
  const double start = input.t_tool.empty() ? 0.0 : input.t_tool.front();
  Expected<LiveRobotSite> site = LiveRobotSite::create(input, options->teleop, start);
  if (!site) return site.error();
  const SiteScene site_scene = site_scene_of(*scene, input);
  const auto black_box = open_black_box(arguments.site, site_scene, configuration);
  if (!black_box) return black_box.error();
  const auto publisher = open_publisher(
      source->publishes_by.empty() ? arguments.site.publish : source->publishes_by, site_scene);
  if (!publisher) return publisher.error();
  const std::atomic<bool>& stop = stop_on_signals();
  announce(*server, *robot, arguments);
  const Expected<RobotSiteReport> report =
      run_robot_site(*server, *robot, *site, site_scene, configuration.robot_site, observer, stop,
                     black_box->get(), publisher->get());
  if (!report) return report.error();
  if (source->plant != nullptr) {
    Expected<void> written = source->plant->write_truth(source->truth->path());
    if (written) written = source->truth->commit();
    if (!written) return written.error();
  }
  CommandResult result = describe_robot_site(*report);
  close_black_box(black_box->get(), arguments.site.log, observer, result);
  return result;
}

}  // namespace

void add_robot_site(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "robot-site", "Run the robot's site: measure, identify, and correct the operator's world");
  command->footer(
      "Example:\n  pcavr robot-site my_scene --plant push --seed 1 --key robot.key "
      "--authorized operators --host 0.0.0.0");
  auto arguments = std::make_shared<RobotSiteArguments>();
  add_site_options(*command, arguments->site);
  CLI::Option* recording =
      command->add_option("--recording", arguments->site.recording,
                          "Play this recording in real time in place of a robot");
  CLI::Option* ros2 =
      command
          ->add_option("--ros2", arguments->ros2,
                       "Connect to a robot by the ROS 2 topics that this YAML file names")
          ->excludes(recording);
  CLI::Option* plugin =
      command
          ->add_option("--plugin", arguments->plugin,
                       "Robot behind a vendor's controller: a shared library, FILE.so or "
                       "FILE.so,OPTIONS")
          ->excludes(recording)
          ->excludes(ros2);
  CLI::Option* plant =
      command
          ->add_option("--plant", arguments->plant,
                       "Simulate a robot in real time that follows the commands: the case of pcavr "
                       "simulate that the scene was made from")
          ->excludes(recording)
          ->excludes(ros2)
          ->excludes(plugin);
  command
      ->add_option("--plant-truth", arguments->truth,
                   "Write what the plant truly did to this folder at the end, for evaluate --truth")
      ->needs(plant);
  add_seed(*command, arguments->seed, "Seed of the plant, as given to pcavr simulate")
      ->capture_default_str();
  command->add_option("--tracked", arguments->site.tracked,
                      "Run whose tracking is used instead of tracking again");
  command->add_option("--host", arguments->site.host, "Address to listen on")
      ->capture_default_str();
  command->add_option("--authorized", arguments->authorized,
                      "Folder with the public keys of the operators' sites; deleting a file "
                      "revokes it");
  command->add_flag("--no-corrections", arguments->without_corrections,
                    "Predict only: no corrections are sent");
  command->callback([arguments, &configuration, &action, &app] {
    arguments->as_json = app.get_option("--json")->count() > 0;
    action = [arguments, &configuration](const Observer& observer) {
      return robot_site(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
