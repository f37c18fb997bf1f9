// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "pcavr/pipeline/teleop_input.hpp"

#include "commands.hpp"
#include "link_arguments.hpp"
#include "link_options.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

struct OperatorSiteArguments {
  SiteArguments site;
  std::string robot_key;  ///< file
  SimulatedNetwork network;
};

Expected<LinkClient> open_client(const OperatorSiteArguments& arguments) {
  Expected<std::optional<LinkKeys>> keys = keys_of(arguments.site);
  if (!keys) return keys.error();
  if (keys->has_value() == arguments.robot_key.empty()) {
    return Error{.message = "--key and --robot-key must be given together"};
  }
  LinkClientOptions options{.host = arguments.site.host,
                            .port = arguments.site.port,
                            .keys = std::move(*keys),
                            .robot_key = {}};
  if (!arguments.robot_key.empty()) {
    Expected<std::string> robot_key = read_public_link_key(arguments.robot_key);
    if (!robot_key) return robot_key.error();
    options.robot_key = std::move(*robot_key);
  }
  return LinkClient::open(options);
}

CommandResult describe_operator_site(const OperatorSiteReport& report) {
  CommandResult result;
  const double commands = static_cast<double>(std::max<std::size_t>(report.commands, 1));
  result.summary = fmt::format(
      "sessions {}, interruptions {}\ncommands {}, {:.1f} ms ahead, {} late cycles, {:.1f} us CPU "
      "each\ncorrections {}, {} received again, {} too late\nclock      drift {:.1f} ppm, std "
      "{:.0f} us, round trip at least {:.2f} ms\n",
      report.sessions, report.interruptions.size(), report.commands, 1e3 * report.lead,
      report.late_cycles, 1e6 * report.cpu / commands, report.corrections,
      report.repeated_corrections, report.late_corrections, 1e6 * report.clock_drift,
      1e6 * report.clock_std, 1e3 * report.round_trip);
  result.json = {{"sessions", report.sessions},
                 {"commands", report.commands},
                 {"corrections", report.corrections},
                 {"repeated_corrections", report.repeated_corrections},
                 {"late_corrections", report.late_corrections},
                 {"invalid_messages", report.invalid_messages},
                 {"late_cycles", report.late_cycles},
                 {"lead_s", report.lead},
                 {"round_trip_s", report.round_trip},
                 {"clock_drift", report.clock_drift},
                 {"clock_std_s", report.clock_std},
                 {"cpu_s", report.cpu},
                 {"t_corrected", report.t_corrected}};
  result.json["interruptions"] = nlohmann::ordered_json::array();
  for (const OperatorSiteReport::Interruption& interruption : report.interruptions) {
    result.json["interruptions"].push_back(
        {{"t", interruption.t}, {"duration_s", interruption.duration}});
    result.summary += fmt::format("  interrupted at {:.2f} s for {:.2f} s\n", interruption.t,
                                  interruption.duration);
  }
  return result;
}

Expected<CommandResult> operator_site(const OperatorSiteArguments& arguments,
                                      const Configuration& configuration,
                                      const Observer& observer) {
  const Expected<ReplayOptions> options = site_options(arguments.site, configuration);
  if (!options) return options.error();
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.site.scene);
  if (!scene) return scene.error();
  const Expected<Recording> trace =
      read_with_warnings(arguments.site.recording, false, configuration, observer);
  if (!trace) return trace.error();
  Expected<TeleopInput> world = read_teleop_world(*scene, *options, observer);
  if (!world) return world.error();
  add_tool_motion(*trace, *world);
  Expected<LinkClient> client = open_client(arguments);
  if (!client) return client.error();
  const std::atomic<bool>& stop = stop_on_signals();
  const Expected<OperatorSiteReport> report =
      run_operator_site(*client, *world, options->teleop, site_scene_of(*scene, *world),
                        configuration.operator_site, arguments.network, observer, stop);
  if (!report) return report.error();
  return describe_operator_site(*report);
}

}  // namespace

void add_operator_site(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "operator-site", "Run the operator's site: predict the remote world, command the tool");
  command->footer(
      "Example:\n  pcavr operator-site my_scene --trace my_recording --host robot.example "
      "--key alice.key --robot-key robot.pub");
  auto arguments = std::make_shared<OperatorSiteArguments>();
  add_site_options(*command, arguments->site);
  command
      ->add_option("--trace", arguments->site.recording,
                   "Recording whose tool motion is the operator's command")
      ->required();
  command->add_option("--host", arguments->site.host, "Address of the robot's site")
      ->capture_default_str();
  command->add_option("--robot-key", arguments->robot_key, "Public key of the robot's site");
  SimulatedNetwork& network = arguments->network;
  add_number(*command, "--forward-delay", network.forward.delay, ranges::kDelay,
             "Simulated network: delay from operator to robot, besides the real one [s]")
      ->capture_default_str();
  add_number(*command, "--backward-delay", network.backward.delay, ranges::kDelay,
             "Simulated network: delay from robot to operator [s]")
      ->capture_default_str();
  add_link_conditions(*command, network.forward, network.backward);
  add_seed(*command, network.seed, "Seed of the simulated network")->capture_default_str();
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return operator_site(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
