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

#include "pcavr/devices/open_device.hpp"
#include "pcavr/devices/remote_device.hpp"
#include "pcavr/haptics/haptic_world.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recording/parameters_file.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/serve/certificate.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/replay_content.hpp"
#include "pcavr/serve/scene_content.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "serve_words.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

constexpr char kPageDevice[] = "page";
/// [N] What is shown of the force where no motor makes it: more than any push on a table.
constexpr double kMaxShownForce = 100.0;
/// [N] of a device of which nothing else is known: what the weakest of them bear.
constexpr double kMaxDeviceForce = 5.0;

struct ServeArguments {
  std::string scene;
  std::string recording;
  std::string tracked;
  std::string parameters;
  std::string page;
  std::string device = kPageDevice;
  std::string certificate;
  std::string key;
  bool with_tls = false;
  double tool_radius = 0.0;  ///< [m]; 0: not said
  double max_force = 0.0;    ///< [N]; 0: not said
  ServerOptions server;
  bool as_json = false;
};

/// What was read and made before anything is served.
struct Stage {
  SceneManifest scene;
  std::optional<ParameterTable> parameters;
  std::optional<Recording> recording;
};

/// The replay's paths where there is one, the scene's for the rest.
class StageContent final : public ContentSource {
 public:
  StageContent(SceneContent scene, std::optional<ReplayContent> replay)
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

/// Beside the command as it was built, or where it was installed to.
Expected<fs::path> find_page() {
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& place : {folder / "../viewer", folder / "../viewer/dist",
                                folder / "../share/pcavr/viewer", fs::path(PCAVR_SOURCE_PAGE)}) {
    if (fs::exists(place / "index.html", ignored)) return place;
  }
  return Error{.message = "the page was not built",
               .hint = "npm ci && npm run build in apps/viewer, or name its folder by --page"};
}

Expected<std::optional<TlsFiles>> tls_files(const ServeArguments& arguments) {
  if (arguments.certificate.empty() != arguments.key.empty()) {
    return Error{.message = "--certificate and --key go together"};
  }
  if (!arguments.key.empty()) return std::optional(TlsFiles{arguments.certificate, arguments.key});
  if (!arguments.with_tls) return std::optional<TlsFiles>();
  Expected<TlsFiles> own = own_certificate(data_folder());
  if (!own) return own.error();
  return std::optional(std::move(*own));
}

Expected<Stage> read_stage(const ServeArguments& arguments, const Observer& observer) {
  Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  Stage stage{std::move(*scene), {}, {}};
  if (!arguments.parameters.empty()) {
    Expected<ParameterTable> parameters = read_parameters(arguments.parameters);
    if (!parameters) return parameters.error();
    stage.parameters = std::move(*parameters);
  }
  if (!arguments.recording.empty()) {
    Expected<Recording> recording = read_with_warnings(arguments.recording, false, observer);
    if (!recording) return recording.error();
    stage.recording = std::move(*recording);
  }
  return stage;
}

Expected<StageContent> make_content(const Stage& stage, const ServeArguments& arguments,
                                    const Observer& observer) {
  Expected<SceneContent> scene = SceneContent::create(stage.scene, stage.parameters, observer);
  if (!scene) return scene.error();
  if (!stage.recording) return StageContent(std::move(*scene), {});
  ReplayOptions options;
  options.parameters = stage.parameters;
  options.parameters_file = arguments.parameters;
  if (!arguments.tracked.empty()) options.tracked = arguments.tracked;
  const Expected<Replay> replay =
      replay_recording(*stage.recording, stage.scene, options, observer);
  if (!replay) return replay.error();
  Expected<ReplayContent> shown =
      ReplayContent::create(*stage.recording, stage.scene, *replay, observer);
  if (!shown) return shown.error();
  return StageContent(std::move(*scene), std::move(*shown));
}

Expected<SceneWorld> make_world(const Stage& stage, const ServeArguments& arguments,
                                const Observer& observer) {
  SceneWorldOptions options;
  options.parameters = stage.parameters;
  options.parameters_file = arguments.parameters;
  if (stage.recording) {
    options.tool_radius = stage.recording->manifest.tool_radius.value_or(options.tool_radius);
  }
  if (arguments.tool_radius > 0.0) options.tool_radius = arguments.tool_radius;
  options.max_force = arguments.device == kPageDevice ? kMaxShownForce : kMaxDeviceForce;
  if (arguments.max_force > 0.0) options.max_force = arguments.max_force;
  Expected<SceneWorld> world = make_scene_world(stage.scene, options);
  if (!world) return world;
  for (const std::string& note : world->notes) observer.on_warning(note);
  for (const AssumedNumbers& body : world->assumed) {
    if (body.names.empty()) continue;
    std::string line = body.object + ": assumed, because nothing told them:";
    for (const std::string& name : body.names) line += ' ' + name;
    observer.on_warning(line);
  }
  return world;
}

Expected<std::unique_ptr<LiveWorld>> make_live(const SceneWorld& scene,
                                               const std::string& device_name) {
  Expected<HapticWorld> haptic = HapticWorld::create(scene.model);
  if (!haptic) return haptic.error();
  std::unique_ptr<Device> device =
      std::make_unique<RemoteDevice>(RemoteDeviceOptions{.name = kPageDevice});
  if (device_name != kPageDevice) {
    Expected<std::unique_ptr<Device>> opened = open_device(device_name);
    if (!opened) return opened.error();
    device = std::move(*opened);
  }
  return std::make_unique<LiveWorld>(std::move(*haptic), std::move(device),
                                     LiveWorldOptions{.p_base_tool_start = scene.p_base_tool_start,
                                                      .full_force = scene.full_force});
}

bool is_long(const std::string& host) { return host.find(':') != std::string::npos; }

bool is_everywhere(const std::string& host) { return host == "0.0.0.0" || host == "::"; }

/// Where a browser finds it: all of the machine's addresses where it listens at all of them.
std::vector<std::string> addresses_of(const LiveServer& server, const ServerOptions& options) {
  std::vector<std::string> hosts{options.host};
  if (is_everywhere(options.host)) hosts = machine_addresses();
  if (options.host == "0.0.0.0") std::erase_if(hosts, is_long);
  if (hosts.empty()) hosts.emplace_back("localhost");
  std::vector<std::string> addresses;
  addresses.reserve(hosts.size());
  for (const std::string& host : hosts) {
    addresses.push_back((options.tls ? "https://" : "http://") +
                        (is_long(host) ? '[' + host + ']' : host) + ':' +
                        std::to_string(server.port()) + '/');
  }
  return addresses;
}

Expected<void> announce(const LiveServer& server, const LiveWorld& world,
                        const ServeArguments& arguments, std::size_t triangles) {
  ServeFacts facts{
      .addresses = addresses_of(server, arguments.server),
      .port = server.port(),
      .scene = arguments.server.scene,
      .mode = arguments.server.is_replay ? "replay" : "live",
      .device = std::string(world.device_name()),
      .objects = world.names(),
      .triangles = triangles,
      .code = server.pairing_code(),
      .is_local = server.pairing_code().empty(),
      .is_at_localhost = server.pairing_code().empty() || is_everywhere(arguments.server.host),
      .is_tls = arguments.server.tls.has_value()};
  if (arguments.server.tls) {
    const Expected<CertificateFacts> certificate =
        read_certificate(arguments.server.tls->certificate);
    if (!certificate) return certificate.error();
    facts.fingerprint = certificate->fingerprint;
  }
  std::cout << (arguments.as_json ? json_text(ready_json(facts), -1) : ready_words(facts))
            << std::flush;
  return {};
}

Expected<CommandResult> run(LiveServer& server, LiveWorld& world, const ServeArguments& arguments,
                            std::size_t triangles, const Observer& observer) {
  const Expected<std::vector<std::string>> notes = world.start();
  if (!notes) return notes.error();
  for (const std::string& note : *notes) observer.on_warning(note);
  const Expected<void> announced = announce(server, world, arguments, triangles);
  if (!announced) return announced.error();
  server.run();
  world.stop();
  const WorldSnapshot& last = world.newest();
  CommandResult result;
  result.summary = "ended after " + std::to_string(last.cycles) + " cycles, " +
                   std::to_string(last.late_cycles) + " of them late\n";
  const CycleTimes times = world.times();
  result.json = {{"cycles", last.cycles},       {"late_cycles", last.late_cycles},
                 {"cycle_p50_s", times.median}, {"cycle_p99_s", times.p99},
                 {"cycle_p999_s", times.p999},  {"cycle_longest_s", times.longest}};
  return result;
}

Expected<CommandResult> serve(ServeArguments arguments, const Observer& observer) {
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
  // Before anything that takes long.
  const Expected<void> possible = check_server(options);
  if (!possible) return possible.error();
  const Expected<Stage> stage = read_stage(arguments, observer);
  if (!stage) return stage.error();
  options.scene = scene_name(stage->scene);
  Expected<SceneWorld> scene = make_world(*stage, arguments, observer);
  if (!scene) return scene.error();
  options.tool_radius = scene->model.world.tool_radius;
  Expected<std::unique_ptr<LiveWorld>> world = make_live(*scene, arguments.device);
  if (!world) return world.error();
  const Expected<StageContent> content = make_content(*stage, arguments, observer);
  if (!content) return content.error();
  Expected<LiveServer> server = LiveServer::open(options, **world, *content);
  if (!server) return server.error();
  return run(*server, **world, arguments, scene->triangles, observer);
}

void add_network_options(CLI::App& command, ServeArguments& arguments) {
  add_whole<std::uint16_t>(command, "--port", arguments.server.port, 0,
                           std::numeric_limits<std::uint16_t>::max(), "0: any that is free")
      ->capture_default_str();
  command
      .add_option("--host", arguments.server.host,
                  "Address to listen at; others than this machine's own want --tls, and then "
                  "a code that is shown here")
      ->capture_default_str();
  command.add_flag("--tls", arguments.with_tls,
                   "https, with a certificate that is made for this machine and kept");
  command.add_option("--certificate", arguments.certificate, "https with your own: PEM, its chain");
  command.add_option("--key", arguments.key, "The certificate's key: PEM");
  add_number(command, "--rate", arguments.server.rate, ranges::kStateRate,
             "States to each page [Hz]")
      ->capture_default_str();
  command.add_option("--page", arguments.page, "Folder of the built page");
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "serve",
      "Stand in a scene and push: a page for browsers and headsets, the world at 1 kHz behind it");
  command->footer(
      "Example:\n  pcavr serve my_scene --parameters my_parameters.yaml\n"
      "With --json: a line with port and addresses once it answers, and a result at the end.");
  auto arguments = std::make_shared<ServeArguments>();
  command->add_option("scene", arguments->scene, "Folder that pcavr build wrote")->required();
  command->add_option("--replay", arguments->recording, "Show this recording, replayed");
  command
      ->add_option("--tracked", arguments->tracked,
                   "Take the replay's tracking from this run instead of doing it again")
      ->needs("--replay");
  command->add_option("--parameters", arguments->parameters, "What identify wrote");
  add_network_options(*command, *arguments);
  command
      ->add_option("--device", arguments->device,
                   "What moves the tool: page, " + std::string(kDeviceChoices))
      ->capture_default_str();
  add_number(*command, "--tool-radius", arguments->tool_radius, ranges::kToolRadius,
             "Of the tool's ball [m]; else the replay's, or 0.01");
  add_number(*command, "--most-force", arguments->max_force, ranges::kHandForce,
             "On the hand [N]; else 5 for a device, and 100 where a page shows it");
  command->callback([arguments, &action, &app] {
    arguments->as_json = app.get_option("--json")->count() > 0;
    action = [arguments](const Observer& observer) { return serve(*arguments, observer); };
  });
}

}  // namespace pcavr::app
