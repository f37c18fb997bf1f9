// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "pcavr/core/json_text.hpp"
#include "pcavr/pipeline/recorded_robot.hpp"
#include "pcavr/pipeline/teleop_input.hpp"

#include "commands.hpp"
#include "link_arguments.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

struct RobotSiteArguments {
  SiteArguments site;
  std::string authorized;
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
      "sessions {}, holds {}\ncommands {}, {} discarded\ncorrections {}, {} bytes of {} that "
      "streaming would send, {} sent again\ncycles {}, {} late, {:.1f} us CPU each, {:.2f} ms at "
      "most with corrections\n",
      report.sessions, report.holds, report.commands, report.discarded_commands,
      report.corrections.size(), report.correction_bytes, report.streaming_bytes,
      report.repeated_corrections, report.cycles, report.late_cycles, 1e6 * report.cpu / cycles,
      1e3 * report.max_correction_time);
  for (const std::string& note : report.notes) result.summary += "  note: " + note + '\n';
  result.json = {{"sessions", report.sessions},
                 {"holds", report.holds},
                 {"commands", report.commands},
                 {"discarded_commands", report.discarded_commands},
                 {"invalid_messages", report.invalid_messages},
                 {"repeated_corrections", report.repeated_corrections},
                 {"correction_bytes", report.correction_bytes},
                 {"streaming_bytes", report.streaming_bytes},
                 {"cycles", report.cycles},
                 {"late_cycles", report.late_cycles},
                 {"cpu_s", report.cpu},
                 {"max_correction_cpu_s", report.max_correction_time},
                 {"notes", report.notes}};
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

Expected<CommandResult> robot_site(const RobotSiteArguments& arguments,
                                   const Configuration& configuration, const Observer& observer) {
  Expected<LinkServer> server = open_server(arguments);
  if (!server) return server.error();
  Expected<ReplayOptions> options = site_options(arguments.site, configuration);
  if (!options) return options.error();
  if (arguments.without_corrections) options->teleop.with_corrections = false;
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.site.scene);
  if (!scene) return scene.error();
  const Expected<Recording> recording =
      read_with_warnings(arguments.site.recording, false, configuration, observer);
  if (!recording) return recording.error();
  const Expected<TeleopInput> input = read_teleop_input(*recording, *scene, *options, observer);
  if (!input) return input.error();
  if (input->t_tool.size() < 2) {
    return Error{.message = "the recording has no motion of the tool",
                 .file = arguments.site.recording};
  }
  Expected<LiveRobotSite> site =
      LiveRobotSite::create(*input, options->teleop, input->t_tool.front());
  if (!site) return site.error();
  const std::unique_ptr<RobotInterface> robot =
      make_recorded_robot(*input, options->teleop.pose.tracking_latency);
  const std::atomic<bool>& stop = stop_on_signals();
  announce(*server, *robot, arguments);
  const Expected<RobotSiteReport> report =
      run_robot_site(*server, *robot, *site, site_scene_of(*scene, *input),
                     configuration.robot_site, observer, stop);
  if (!report) return report.error();
  return describe_robot_site(*report);
}

}  // namespace

void add_robot_site(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "robot-site", "Run the robot's site: measure, identify, and correct the operator's world");
  command->footer(
      "Example:\n  pcavr robot-site my_scene --recording my_recording --key robot.key "
      "--authorized operators --host 0.0.0.0");
  auto arguments = std::make_shared<RobotSiteArguments>();
  add_site_options(*command, arguments->site);
  command
      ->add_option("--recording", arguments->site.recording,
                   "Play this recording in real time in place of a robot")
      ->required();
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
