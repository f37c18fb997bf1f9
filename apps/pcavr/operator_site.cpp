// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <fmt/core.h>

#include "pcavr/pipeline/teleop_input.hpp"
#include "pcavr/serve/operator_page.hpp"
#include "pcavr/serve/scene_content.hpp"
#include "pcavr/teleoperation/devices/open_device.hpp"

#include "commands.hpp"
#include "link_arguments.hpp"
#include "link_options.hpp"
#include "number_option.hpp"
#include "page_server.hpp"
#include "summary.hpp"

namespace pcavr::app {
namespace {

struct OperatorSiteArguments {
  SiteArguments site;
  std::string robot_key;  ///< file
  SimulatedNetwork network;
  PageArguments page;  ///< without --trace
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
      "each, 99.9 % within {:.0f} us\ncorrections {}, {} received again, {} too late\npictures {}, "
      "{:.0f} ms old\nclock     "
      " drift {:.1f} ppm, std "
      "{:.0f} us, round trip at least {:.2f} ms\n",
      report.sessions, report.interruptions.size(), report.commands, 1e3 * report.lead,
      report.late_cycles, 1e6 * report.cpu / commands, 1e6 * report.cycle_times.p999,
      report.corrections, report.repeated_corrections, report.late_corrections, report.pictures,
      1e3 * report.picture_age, 1e6 * report.clock_drift, 1e6 * report.clock_std,
      1e3 * report.round_trip);
  result.json = {{"sessions", report.sessions},
                 {"commands", report.commands},
                 {"corrections", report.corrections},
                 {"repeated_corrections", report.repeated_corrections},
                 {"late_corrections", report.late_corrections},
                 {"invalid_messages", report.invalid_messages},
                 {"late_cycles", report.late_cycles},
                 {"pictures", report.pictures},
                 {"picture_age_s", report.picture_age},
                 {"lead_s", report.lead},
                 {"correction_delay_s", report.correction_delay},
                 {"round_trip_s", report.round_trip},
                 {"clock_drift", report.clock_drift},
                 {"clock_std_s", report.clock_std},
                 {"cpu_s", report.cpu},
                 {"t_corrected", report.t_corrected}};
  add_cycle_times(report.cycle_times, result.json);
  for (const DelayMeans::Stage& stage : report.delays.stages()) {
    result.json["delays_s"][std::string(stage.name)] = stage.mean;
    result.summary += fmt::format("  {:<22} {:.1f} ms\n", stage.name, 1e3 * stage.mean);
  }
  result.json["interruptions"] = nlohmann::ordered_json::array();
  for (const OperatorSiteReport::Interruption& interruption : report.interruptions) {
    result.json["interruptions"].push_back(
        {{"t", interruption.t}, {"duration_s", interruption.duration}});
    result.summary += fmt::format("  interrupted at {:.2f} s for {:.2f} s\n", interruption.t,
                                  interruption.duration);
  }
  return result;
}

/// Inputs that both kinds of operator have in common.
struct OperatorInputs {
  ReplayOptions options;
  SceneManifest scene;
  TeleopInput world;
};

Expected<OperatorInputs> read_operator_inputs(const SiteArguments& arguments,
                                              const Configuration& configuration,
                                              const Observer& observer) {
  Expected<ReplayOptions> options = site_options(arguments, configuration);
  if (!options) return options.error();
  Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  Expected<TeleopInput> world = read_teleop_world(*scene, *options, observer);
  if (!world) return world.error();
  return OperatorInputs{std::move(*options), std::move(*scene), std::move(*world)};
}

Expected<CommandResult> run_recorded(const OperatorSiteArguments& arguments, OperatorInputs& inputs,
                                     const Configuration& configuration, const Observer& observer) {
  const Expected<Recording> trace =
      read_with_warnings(arguments.site.recording, false, configuration, observer);
  if (!trace) return trace.error();
  add_tool_motion(*trace, inputs.world);
  Expected<LinkClient> client = open_client(arguments);
  if (!client) return client.error();
  const Expected<std::unique_ptr<OperatorInterface>> interface =
      make_recorded_operator(inputs.world, inputs.options.teleop);
  if (!interface) return interface.error();
  const SiteScene scene = site_scene_of(inputs.scene, inputs.world);
  const auto black_box = open_black_box(arguments.site, scene, configuration);
  if (!black_box) return black_box.error();
  const auto publisher = open_publisher(arguments.site.publish, scene);
  if (!publisher) return publisher.error();
  const std::atomic<bool>& stop = stop_on_signals();
  const Expected<OperatorSiteReport> report = run_operator_site(
      *client, **interface, inputs.world, inputs.options.teleop, scene, configuration.operator_site,
      arguments.network, observer, stop, black_box->get(), publisher->get());
  if (!report) return report.error();
  CommandResult result = describe_operator_site(*report);
  close_black_box(black_box->get(), arguments.site.log, observer, result);
  return result;
}

Expected<std::unique_ptr<OperatorPage>> make_operator_page(const OperatorSiteArguments& arguments,
                                                           const OperatorInputs& inputs,
                                                           SceneWorld& scene,
                                                           const Configuration& configuration) {
  Expected<std::unique_ptr<Device>> device = make_device(arguments.page, configuration);
  if (!device) return device.error();
  Expected<std::unique_ptr<LiveArm>> arm = make_arm(inputs.scene, scene, configuration);
  if (!arm) return arm.error();
  LiveWorldOptions options = configuration.live;
  options.p_base_tool_start = scene.p_base_tool_start;
  options.full_scale_force = scene.full_scale_force;
  std::vector<std::string> names;
  for (const TeleopObject& object : inputs.world.objects) names.push_back(object.name);
  return OperatorPage::create(std::move(scene.model), names, std::move(*device), options,
                              configuration.robot_site.limits, std::move(*arm));
}

/// The site on a thread of its own, the server on this one; each ends the other.
Expected<CommandResult> run_both(LiveServer& server, OperatorPage& page, LinkClient& client,
                                 const OperatorSiteArguments& arguments,
                                 const OperatorInputs& inputs, const Configuration& configuration,
                                 const Observer& observer) {
  const SiteScene scene = site_scene_of(inputs.scene, inputs.world);
  const auto black_box = open_black_box(arguments.site, scene, configuration);
  if (!black_box) return black_box.error();
  const auto publisher = open_publisher(arguments.site.publish, scene);
  if (!publisher) return publisher.error();
  std::atomic<bool> stop = false;
  std::optional<Expected<OperatorSiteReport>> report;
  std::thread site([&] {
    report.emplace(run_operator_site(client, page, inputs.world, inputs.options.teleop, scene,
                                     configuration.operator_site, arguments.network, observer, stop,
                                     black_box->get(), publisher->get()));
    server.stop();
  });
  server.run();
  stop = true;
  site.join();
  if (!*report) return report->error();
  CommandResult result = describe_operator_site(**report);
  close_black_box(black_box->get(), arguments.site.log, observer, result);
  return result;
}

Expected<CommandResult> run_page(OperatorSiteArguments arguments, OperatorInputs& inputs,
                                 const Configuration& configuration, const Observer& observer) {
  ServerOptions& options = arguments.page.server;
  options.scene = scene_name(inputs.scene);
  Expected<SceneWorld> scene =
      make_page_world(inputs.scene, inputs.options.parameters, inputs.world.tool_radius,
                      arguments.page, configuration, observer);
  if (!scene) return scene.error();
  options.tool_radius = scene->model.world.tool_radius;
  const std::size_t triangles = scene->triangles;
  Expected<ViewerScene> viewer =
      make_viewer_scene(inputs.scene, scene->model, inputs.options.parameters);
  if (!viewer) return viewer.error();
  const Expected<std::unique_ptr<OperatorPage>> page =
      make_operator_page(arguments, inputs, *scene, configuration);
  if (!page) return page.error();
  const Expected<SceneContent> content = SceneContent::create(
      inputs.scene, inputs.options.parameters, observer, Parallelism::max(), configuration.content);
  if (!content) return content.error();
  RobotPicture pictures(*content);
  (*page)->set_pictures(pictures);
  Expected<LinkClient> client = open_client(arguments);
  if (!client) return client.error();
  Expected<LiveServer> server = LiveServer::open(options, **page, pictures, std::move(*viewer));
  if (!server) return server.error();
  const Expected<void> printed = print_startup_message(*server, **page, arguments.page, triangles);
  if (!printed) return printed.error();
  return run_both(*server, **page, *client, arguments, inputs, configuration, observer);
}

Expected<CommandResult> operator_site(OperatorSiteArguments arguments,
                                      const Configuration& configuration,
                                      const Observer& observer) {
  const bool has_page = arguments.site.recording.empty();
  // Errors are reported before the long work.
  const Expected<void> possible =
      has_page ? prepare_server(arguments.page, configuration) : Expected<void>();
  if (!possible) return possible.error();
  Expected<OperatorInputs> inputs = read_operator_inputs(arguments.site, configuration, observer);
  if (!inputs) return inputs.error();
  return has_page ? run_page(std::move(arguments), *inputs, configuration, observer)
                  : run_recorded(arguments, *inputs, configuration, observer);
}

/// The page's options carry a prefix: --host, --port and --key are those of the robot's site.
void add_page_options(CLI::App& command, ServerOptions& network, PageArguments& page) {
  add_whole<std::uint16_t>(command, "--page-port", network.port, 0,
                           std::numeric_limits<std::uint16_t>::max(),
                           "TCP port of the page; 0: any free port")
      ->capture_default_str();
  command
      .add_option("--page-host", network.host,
                  "Address of the page; other than a loopback address needs --tls and the pairing "
                  "code that is printed at the start")
      ->capture_default_str();
  command.add_flag("--tls", page.with_tls, "Serve the page by https, as pcavr serve does");
  command.add_option("--page", page.page, "Folder of the built web page");
  command
      .add_option(
          "--device", page.device,
          "Haptic or input device that moves the tool: page, " + std::string(kDeviceChoices))
      ->capture_default_str();
}

}  // namespace

void add_operator_site(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "operator-site", "Run the operator's site: predict the remote world, command the tool");
  command->footer(
      "Example:\n  pcavr operator-site my_scene --host robot.example --key alice.key "
      "--robot-key robot.pub");
  auto arguments = std::make_shared<OperatorSiteArguments>();
  add_site_options(*command, arguments->site);
  command->add_option("--trace", arguments->site.recording,
                      "Recording whose tool motion is the operator's command; default: a page");
  add_page_options(*command, configuration.network, arguments->page);
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
  command->callback([arguments, &configuration, &action, &app] {
    arguments->page.as_json = app.get_option("--json")->count() > 0;
    arguments->page.parameters = arguments->site.parameters;
    arguments->page.is_operator_site = true;
    action = [arguments, &configuration](const Observer& observer) {
      return operator_site(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
