// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/arm/identified_arm.hpp"
#include "pcavr/core/json_text.hpp"
#include "pcavr/devices/open_device.hpp"
#include "pcavr/devices/remote_device.hpp"
#include "pcavr/haptics/haptic_world.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/serve/certificate.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/replay_content.hpp"
#include "pcavr/serve/scene_arm.hpp"
#include "pcavr/serve/scene_content.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"

#include "commands.hpp"
#include "damping_option.hpp"
#include "number_option.hpp"
#include "startup_message.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

constexpr char kPageDevice[] = "page";
/// Of the device's force.
constexpr double kMaxWeightShare = 0.5;
constexpr InputRange kTimeScale{"time scale", 0.1, 1.0, "", "slower: nothing seems to move"};

struct ServeArguments {
  std::string scene;
  std::string recording;
  std::string tracked;
  std::string parameters;
  std::string damping_law;  ///< empty: the file's damping
  std::string page;
  std::string device = kPageDevice;
  std::string certificate;
  std::string key;
  std::string identified;  ///< report of identify robot
  bool is_torque_driven = false;
  bool with_tls = false;
  double tool_radius = 0.0;  ///< [m]; 0: not given
  double max_force = 0.0;    ///< [N]; 0: not given
  double time_scale = 0.0;   ///< 0: not given
  ServerOptions server;      ///< the configuration's, completed by what serve finds
  bool as_json = false;
};

/// The inputs, read before anything is served.
struct ServeInputs {
  SceneManifest scene;
  std::optional<ParameterTable> parameters;
  std::optional<Recording> recording;
};

/// Serves the replay's paths where there is a replay, and the scene's.
class ServedContent final : public ContentSource {
 public:
  ServedContent(SceneContent scene, std::optional<ReplayContent> replay)
      : scene_(std::move(scene)), replay_(std::move(replay)) {}

  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const override {
    if (replay_) {
      Expected<std::shared_ptr<const Content>> found = replay_->find(path);
      if (!found || *found) return found;
    }
    return scene_.find(path);
  }

 private:
  SceneContent scene_;
  std::optional<ReplayContent> replay_;
};

/// Next to the executable in the build tree, or in the installation.
Expected<fs::path> find_page() {
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& candidate :
       {folder / "../viewer", folder / "../viewer/dist", folder / "../share/pcavr/viewer",
        fs::path(PCAVR_SOURCE_PAGE)}) {
    if (fs::exists(candidate / "index.html", ignored)) return candidate;
  }
  return Error{
      .message = "the web page is not built",
      .hint = "run npm ci && npm run build in apps/viewer, or give its folder with --page"};
}

Expected<std::optional<TlsFiles>> tls_files(const ServeArguments& arguments) {
  if (arguments.certificate.empty() != arguments.key.empty()) {
    return Error{.message = "--certificate and --key must be given together"};
  }
  if (!arguments.key.empty()) return std::optional(TlsFiles{arguments.certificate, arguments.key});
  if (!arguments.with_tls) return std::optional<TlsFiles>();
  Expected<TlsFiles> own = load_or_create_certificate(data_folder());
  if (!own) return own.error();
  return std::optional(std::move(*own));
}

Expected<ServeInputs> read_inputs(const ServeArguments& arguments,
                                  const Configuration& configuration, const Observer& observer) {
  Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  ServeInputs inputs{std::move(*scene), {}, {}};
  if (!arguments.parameters.empty()) {
    std::vector<std::string> notes;
    Expected<ParameterTable> parameters =
        read_parameters_with_damping(arguments.parameters, arguments.damping_law, notes);
    if (!parameters) return parameters.error();
    for (const std::string& note : notes) observer.on_warning(note);
    inputs.parameters = std::move(*parameters);
  }
  if (!arguments.recording.empty()) {
    Expected<Recording> recording =
        read_with_warnings(arguments.recording, false, configuration, observer);
    if (!recording) return recording.error();
    inputs.recording = std::move(*recording);
  }
  return inputs;
}

Expected<ServedContent> make_content(const ServeInputs& inputs, const ServeArguments& arguments,
                                     const Configuration& configuration, const Observer& observer) {
  Expected<SceneContent> scene = SceneContent::create(inputs.scene, inputs.parameters, observer,
                                                      Parallelism::max(), configuration.content);
  if (!scene) return scene.error();
  if (!inputs.recording) return ServedContent(std::move(*scene), {});
  ReplayOptions options;
  options.perception = configuration.perception();
  options.teleop = configuration.teleop;
  options.parameters = inputs.parameters;
  options.parameters_file = arguments.parameters;
  if (!arguments.tracked.empty()) options.tracked = arguments.tracked;
  const Expected<Replay> replay =
      replay_recording(*inputs.recording, inputs.scene, options, observer);
  if (!replay) return replay.error();
  Expected<ReplayContent> shown = ReplayContent::create(*inputs.recording, inputs.scene, *replay,
                                                        observer, configuration.content);
  if (!shown) return shown.error();
  return ServedContent(std::move(*scene), std::move(*shown));
}

Expected<SceneWorld> make_world(const ServeInputs& inputs, const ServeArguments& arguments,
                                const Configuration& configuration, const Observer& observer) {
  SceneWorldOptions options = configuration.serve;
  options.world = configuration.teleop.world;
  options.unknown_objects = configuration.teleop.unknown_objects;
  options.parameters = inputs.parameters;
  options.parameters_file = arguments.parameters;
  if (inputs.recording) {
    options.tool_radius = inputs.recording->manifest.tool_radius.value_or(options.tool_radius);
  }
  if (arguments.tool_radius > 0.0) options.tool_radius = arguments.tool_radius;
  if (arguments.device == kPageDevice) options.force.max_force = options.max_shown_force;
  if (arguments.max_force > 0.0) options.force.max_force = arguments.max_force;
  const double weight = configuration.live.tool.weight();
  if (arguments.device != kPageDevice) {
    if (weight > kMaxWeightShare * options.force.max_force) {
      return Error{.message = fmt::format("the tool's weight of {:.3g} N leaves too little of the "
                                          "device's {:.3g} N for contacts",
                                          weight, options.force.max_force),
                   .place = "serve.tool.mass",
                   .hint = "give a lighter tool, or the device's force with --max-force"};
    }
    options.force.max_force -= weight;
  }
  Expected<SceneWorld> world = make_scene_world(inputs.scene, options);
  if (!world) return world;
  for (const std::string& note : world->notes) observer.on_warning(note);
  for (const AssumedParameters& body : world->assumed) {
    if (body.names.empty()) continue;
    std::string line = body.object + ": using defaults for:";
    for (const std::string& name : body.names) line += ' ' + name;
    observer.on_warning(line);
  }
  return world;
}

/// With --torque-driven or --identified.
Expected<void> drive_if_requested(const SceneArm& arm, const ServeArguments& arguments,
                                  const Configuration& configuration, LiveArm& live) {
  if (!arguments.identified.empty()) {
    const Expected<IdentifiedArm> found = read_identified_arm(arguments.identified, arm.model);
    if (!found) return found.error();
    if (found->model.dof != arm.model.dof) {
      return Error{.message = "identifies fewer joints than the arm has",
                   .file = arguments.identified,
                   .hint = "identify all joints"};
    }
    drive_by_torques(live, found->model, found->joints, configuration.arm_drive);
  } else if (arguments.is_torque_driven) {
    if (!arm.model.has_inertia()) {
      return Error{.message = "the arm's description has no masses",
                   .file = arm.model.file.string(),
                   .hint = "give what pcavr identify robot found with --identified"};
    }
    drive_by_torques(live, arm.model, {}, configuration.arm_drive);
  }
  return {};
}

Expected<std::unique_ptr<LiveWorld>> make_live(const SceneManifest& manifest,
                                               const SceneWorld& scene,
                                               const ServeArguments& arguments,
                                               const Configuration& configuration) {
  const std::string& device_name = arguments.device;
  Expected<HapticWorld> haptic = HapticWorld::create(scene.model);
  if (!haptic) return haptic.error();
  RemoteDeviceOptions page = configuration.page;
  page.name = kPageDevice;
  std::unique_ptr<Device> device = std::make_unique<RemoteDevice>(page);
  if (device_name != kPageDevice) {
    Expected<std::unique_ptr<Device>> opened = open_device(device_name, configuration.devices);
    if (!opened) return opened.error();
    device = std::move(*opened);
  }
  const Expected<std::optional<SceneArm>> arm = read_scene_arm(manifest);
  if (!arm) return arm.error();
  std::unique_ptr<LiveArm> live_arm;
  if (*arm) {
    live_arm = std::make_unique<LiveArm>(make_live_arm(**arm, scene, configuration.arm));
    const Expected<void> driven = drive_if_requested(**arm, arguments, configuration, *live_arm);
    if (!driven) return driven.error();
  } else if (arguments.is_torque_driven || !arguments.identified.empty()) {
    return Error{.message = "has no arm to drive by torques",
                 .file = arguments.scene,
                 .hint = "omit --torque-driven and --identified"};
  }
  LiveWorldOptions options = configuration.live;
  options.p_base_tool_start = scene.p_base_tool_start;
  options.full_scale_force = scene.full_scale_force;
  if (arguments.time_scale > 0.0) options.time_scale = arguments.time_scale;
  return std::make_unique<LiveWorld>(std::move(*haptic), std::move(device), options,
                                     std::move(live_arm));
}

bool is_ipv6(const std::string& host) { return host.find(':') != std::string::npos; }

/// All interfaces.
bool is_wildcard(const std::string& host) { return host == "0.0.0.0" || host == "::"; }

/// The server's URLs; one for each of the machine's addresses where it listens on all interfaces.
std::vector<std::string> addresses_of(const LiveServer& server, const ServerOptions& options) {
  std::vector<std::string> hosts{options.host};
  if (is_wildcard(options.host)) hosts = machine_addresses();
  if (options.host == "0.0.0.0") std::erase_if(hosts, is_ipv6);
  if (hosts.empty()) hosts.emplace_back("localhost");
  std::vector<std::string> addresses;
  addresses.reserve(hosts.size());
  for (const std::string& host : hosts) {
    addresses.push_back((options.tls ? "https://" : "http://") +
                        (is_ipv6(host) ? '[' + host + ']' : host) + ':' +
                        std::to_string(server.port()) + '/');
  }
  return addresses;
}

Expected<void> print_startup_message(const LiveServer& server, const LiveWorld& world,
                                     const ServeArguments& arguments, std::size_t triangles) {
  StartupInfo info{
      .addresses = addresses_of(server, arguments.server),
      .port = server.port(),
      .scene = arguments.server.scene,
      .mode = arguments.server.is_replay ? "replay" : "live",
      .device = std::string(world.device_name()),
      .objects = world.names(),
      .triangles = triangles,
      .code = server.pairing_code(),
      .is_local = server.pairing_code().empty(),
      .is_at_localhost = server.pairing_code().empty() || is_wildcard(arguments.server.host),
      .is_tls = arguments.server.tls.has_value()};
  if (arguments.server.tls) {
    const Expected<CertificateInfo> certificate =
        read_certificate(arguments.server.tls->certificate);
    if (!certificate) return certificate.error();
    info.fingerprint = certificate->fingerprint;
  }
  std::cout << (arguments.as_json ? json_text(startup_json(info)) + '\n' : startup_message(info))
            << std::flush;
  return {};
}

Expected<CommandResult> run(LiveServer& server, LiveWorld& world, const ServeArguments& arguments,
                            std::size_t triangles, const Observer& observer) {
  const Expected<std::vector<std::string>> notes = world.start();
  if (!notes) return notes.error();
  for (const std::string& note : *notes) observer.on_warning(note);
  const Expected<void> printed = print_startup_message(server, world, arguments, triangles);
  if (!printed) return printed.error();
  server.run();
  world.stop();
  const WorldSnapshot& last = world.newest();
  CommandResult result;
  result.summary = "stopped after " + std::to_string(last.cycles) + " cycles, " +
                   std::to_string(last.late_cycles) + " of them late\n";
  const CycleTimes times = world.times();
  result.json = {{"cycles", last.cycles},       {"late_cycles", last.late_cycles},
                 {"cycle_p50_s", times.median}, {"cycle_p99_s", times.p99},
                 {"cycle_p999_s", times.p999},  {"cycle_longest_s", times.longest}};
  return result;
}

Expected<CommandResult> serve(ServeArguments arguments, const Configuration& configuration,
                              const Observer& observer) {
  arguments.server = configuration.network;
  Expected<std::optional<TlsFiles>> tls = tls_files(arguments);
  if (!tls) return tls.error();
  const Expected<fs::path> page =
      arguments.page.empty() ? find_page() : Expected<fs::path>(arguments.page);
  if (!page) return page.error();
  ServerOptions& options = arguments.server;
  options.tls = std::move(*tls);
  options.page = *page;
  options.version = PCAVR_VERSION;
  options.is_replay = !arguments.recording.empty();
  options.ends_on_signals = true;
  // Before the long work.
  const Expected<void> possible = check_server(options);
  if (!possible) return possible.error();
  const Expected<ServeInputs> inputs = read_inputs(arguments, configuration, observer);
  if (!inputs) return inputs.error();
  options.scene = scene_name(inputs->scene);
  Expected<SceneWorld> scene = make_world(*inputs, arguments, configuration, observer);
  if (!scene) return scene.error();
  options.tool_radius = scene->model.world.tool_radius;
  Expected<std::unique_ptr<LiveWorld>> world =
      make_live(inputs->scene, *scene, arguments, configuration);
  if (!world) return world.error();
  const Expected<ServedContent> content = make_content(*inputs, arguments, configuration, observer);
  if (!content) return content.error();
  Expected<LiveServer> server = LiveServer::open(options, **world, *content);
  if (!server) return server.error();
  return run(*server, **world, arguments, scene->triangles, observer);
}

void add_network_options(CLI::App& command, ServerOptions& network, ServeArguments& arguments) {
  add_whole<std::uint16_t>(command, "--port", network.port, 0,
                           std::numeric_limits<std::uint16_t>::max(), "TCP port; 0: any free port")
      ->capture_default_str();
  command
      .add_option("--host", network.host,
                  "Address to listen on; other than a loopback address needs --tls and the pairing "
                  "code that is printed at the start")
      ->capture_default_str();
  command.add_flag(
      "--tls", arguments.with_tls,
      "Use https, with a self-signed certificate that is created once for this machine");
  command.add_option("--certificate", arguments.certificate,
                     "Use https with your own certificate chain (PEM)");
  command.add_option("--key", arguments.key, "Private key of the certificate (PEM)");
  add_number(command, "--rate", network.rate, ranges::kStateRate,
             "Rate of state messages to each page [Hz]")
      ->capture_default_str();
  command.add_option("--page", arguments.page, "Folder of the built web page");
}

}  // namespace

void add_serve(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "serve", "Serve a scene to browsers and VR headsets, with simulation and haptics at 1 kHz");
  command->footer(
      "Example:\n  pcavr serve my_scene --parameters my_parameters.yaml\n"
      "With --json: one line with port and addresses once it accepts connections, and the "
      "result at the end.");
  auto arguments = std::make_shared<ServeArguments>();
  command->add_option("scene", arguments->scene, "Scene from pcavr build")->required();
  command->add_option("--replay", arguments->recording, "Replay this recording in the scene");
  command
      ->add_option("--tracked", arguments->tracked,
                   "Run whose tracking the replay uses instead of tracking again")
      ->needs("--replay");
  command->add_option("--parameters", arguments->parameters, "Parameter file from pcavr identify");
  add_damping_law(*command, arguments->damping_law, "--parameters");
  add_network_options(*command, configuration.network, *arguments);
  command
      ->add_option(
          "--device", arguments->device,
          "Haptic or input device that moves the tool: page, " + std::string(kDeviceChoices))
      ->capture_default_str();
  add_number(*command, "--tool-radius", arguments->tool_radius, ranges::kToolRadius,
             "Radius of the spherical tool tip [m]; default: the replay's, or 0.01");
  add_number(*command, "--max-force", arguments->max_force, ranges::kHandForce,
             "Limit of the rendered force [N]; default: 5 for a device, 100 for the page");
  command->add_flag("--torque-driven", arguments->is_torque_driven,
                    "The scene's arm moves by its own dynamics, and its tip is the tool: the hand "
                    "feels what the arm touches");
  command->add_option(
      "--identified", arguments->identified,
      "Report folder of pcavr identify robot: --torque-driven with its inertias and "
      "friction instead of the description's");
  add_number(*command, "--time-scale", arguments->time_scale, kTimeScale,
             "Simulated over real time, 0.1 to 1; default: 1");
  command->callback([arguments, &configuration, &action, &app] {
    arguments->as_json = app.get_option("--json")->count() > 0;
    action = [arguments, &configuration](const Observer& observer) {
      return serve(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
