// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/devices/open_device.hpp"
#include "pcavr/devices/remote_device.hpp"
#include "pcavr/haptics/haptic_world.hpp"
#include "pcavr/recording/parameters_file.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/scene_content.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"

#include "commands.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

constexpr char kPageDevice[] = "page";
/// [N] What is shown of the force where no motor makes it: more than any table-top push.
constexpr double kMostShownForce = 100.0;
/// [N] of a device of which nothing else is known: what the weakest of them bear.
constexpr double kMostDeviceForce = 5.0;

struct ServeArguments {
  std::string scene;
  std::string parameters;
  std::string page;
  std::string device = kPageDevice;
  double tool_radius = 0.0;  ///< [m]; 0: not said
  double most_force = 0.0;   ///< [N]; 0: not said
  ServerOptions server;
  bool as_json = false;
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
               .mend = "npm ci && npm run build in apps/viewer, or name its folder by --page"};
}

Expected<std::unique_ptr<Device>> device_of(const std::string& name) {
  if (name == kPageDevice) {
    return std::unique_ptr<Device>(
        std::make_unique<RemoteDevice>(RemoteDeviceOptions{.name = kPageDevice}));
  }
  return open_device(name);
}

Expected<SceneWorld> scene_world(const SceneManifest& scene, const ServeArguments& arguments,
                                 const std::optional<ParameterTable>& parameters,
                                 const Observer& observer) {
  SceneWorldOptions options;
  options.parameters = parameters;
  options.parameters_file = arguments.parameters;
  if (arguments.tool_radius > 0.0) options.tool_radius = arguments.tool_radius;
  const bool is_shown_only = arguments.device == kPageDevice;
  options.most_force = is_shown_only ? kMostShownForce : kMostDeviceForce;
  if (arguments.most_force > 0.0) options.most_force = arguments.most_force;
  Expected<SceneWorld> world = make_scene_world(scene, options);
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

void print_ready(const LiveServer& server, const ServeArguments& arguments) {
  const std::string scheme = arguments.server.tls ? "https" : "http";
  const std::string address =
      scheme + "://" + arguments.server.host + ':' + std::to_string(server.port()) + '/';
  if (arguments.as_json) {
    const nlohmann::ordered_json line{{"port", server.port()}, {"address", address}};
    std::cout << line.dump() << std::endl;
    return;
  }
  std::cout << "serving    " << address << "\n" << std::flush;
}

Expected<CommandResult> serve(ServeArguments arguments, const Observer& observer) {
  if (arguments.page.empty()) {
    const Expected<fs::path> page = find_page();
    if (!page) return page.error();
    arguments.page = page->string();
  }
  const Expected<SceneManifest> scene = read_scene_manifest(arguments.scene);
  if (!scene) return scene.error();
  std::optional<ParameterTable> parameters;
  if (!arguments.parameters.empty()) {
    Expected<ParameterTable> read = read_parameters(arguments.parameters);
    if (!read) return read.error();
    parameters = std::move(*read);
  }
  Expected<SceneWorld> model = scene_world(*scene, arguments, parameters, observer);
  if (!model) return model.error();
  const LiveWorldOptions world_options{.p_base_tool_start = model->p_base_tool_start,
                                       .most_force = model->model.force.most_force};
  const double tool_radius = model->model.world.tool_radius;
  Expected<HapticWorld> haptic = HapticWorld::create(std::move(model->model));
  if (!haptic) return haptic.error();
  Expected<std::unique_ptr<Device>> device = device_of(arguments.device);
  if (!device) return device.error();
  const Expected<SceneContent> content = SceneContent::create(*scene, parameters, observer);
  if (!content) return content.error();

  LiveWorld world(std::move(*haptic), std::move(*device), world_options);
  arguments.server.page = arguments.page;
  arguments.server.version = PCAVR_VERSION;
  arguments.server.scene = fs::weakly_canonical(arguments.scene).filename().string();
  arguments.server.tool_radius = tool_radius;
  arguments.server.ends_on_signals = true;
  Expected<LiveServer> server = LiveServer::open(arguments.server, world, *content);
  if (!server) return server.error();
  const Expected<std::vector<std::string>> notes = world.start();
  if (!notes) return notes.error();
  for (const std::string& note : *notes) observer.on_warning(note);
  print_ready(*server, arguments);
  server->run();
  world.stop();
  const WorldSnapshot& last = world.newest();
  CommandResult result;
  result.summary = "ended: " + std::to_string(last.cycles) + " cycles, " +
                   std::to_string(last.late_cycles) + " late\n";
  result.json = {{"cycles", last.cycles}, {"late_cycles", last.late_cycles}};
  return result;
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("serve", "Stand in a scene: a page in a browser or a headset, with force");
  command->footer("Example:\n  pcavr serve my_scene --parameters my_parameters.yaml");
  auto arguments = std::make_shared<ServeArguments>();
  command->add_option("scene", arguments->scene, "Folder that pcavr build wrote")->required();
  command->add_option("--parameters", arguments->parameters, "What identify wrote");
  command->add_option("--port", arguments->server.port, "0: any that is free")
      ->capture_default_str();
  command->add_option("--host", arguments->server.host, "Address of this machine to listen at")
      ->capture_default_str();
  command->add_option("--page", arguments->page, "Folder of another page than the one built in");
  command
      ->add_option("--device", arguments->device,
                   "What moves the tool: page, " + std::string(kDeviceChoices))
      ->capture_default_str();
  command->add_option("--rate", arguments->server.rate, "States to each page [Hz]")
      ->check(CLI::Range(60.0, 90.0))
      ->capture_default_str();
  command->add_option("--tool-radius", arguments->tool_radius, "Of the tool's ball [m]")
      ->check(CLI::Range(0.0005, 0.1));
  command->add_option("--most-force", arguments->most_force, "That the hand may feel [N]")
      ->check(CLI::Range(0.1, 1000.0));
  command->callback([arguments, &action, &app] {
    arguments->as_json = app.get_option("--json")->count() > 0;
    action = [arguments](const Observer& observer) { return serve(*arguments, observer); };
  });
}

}  // namespace pcavr::app
