// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "link_arguments.hpp"

#include <csignal>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/serve/scene_content.hpp"

#include "number_option.hpp"

namespace pcavr::app {
namespace {

std::atomic<bool> is_stopped = false;
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void stop_on_signal(int) { is_stopped = true; }

}  // namespace

void add_site_options(CLI::App& command, SiteArguments& arguments) {
  command.add_option("scene", arguments.scene, "Scene from pcavr build, the same at both sites")
      ->required();
  command.add_option("--parameters", arguments.parameters, "Parameter file from pcavr identify");
  add_whole<std::uint16_t>(command, "--port", arguments.port, 0,
                           std::numeric_limits<std::uint16_t>::max(),
                           "TCP port of the robot's site")
      ->capture_default_str();
  command.add_option("--key", arguments.key,
                     "This site's secret key, from pcavr keygen; only loopback works without");
  command.add_option(
      "--log", arguments.log,
      "Black box: write what this site sends, receives and measures to this new MCAP "
      "file, some 1 GB an hour; readable also after a crash");
  command.add_option("--publish", arguments.publish,
                     "Publish the predicted bodies, forces and phases on ROS 2 topics, as the "
                     "section publish of this YAML file says");
}

Expected<std::optional<LinkKeys>> keys_of(const SiteArguments& arguments) {
  if (arguments.key.empty()) return std::optional<LinkKeys>();
  Expected<LinkKeys> keys = read_link_keys(arguments.key);
  if (!keys) return keys.error();
  return std::optional(std::move(*keys));
}

Expected<ReplayOptions> site_options(const SiteArguments& arguments,
                                     const Configuration& configuration) {
  ReplayOptions options;
  options.perception = configuration.perception();
  options.teleop = configuration.replayed();
  if (!arguments.tracked.empty()) options.tracked = arguments.tracked;
  if (arguments.parameters.empty()) return options;
  Expected<ParameterTable> parameters = read_parameters(arguments.parameters);
  if (!parameters) return parameters.error();
  options.parameters = std::move(*parameters);
  options.parameters_file = arguments.parameters;
  return options;
}

SiteScene site_scene_of(const SceneManifest& scene, const TeleopInput& world) {
  SiteScene result{.name = scene_name(scene),
                   .version = PCAVR_VERSION,
                   .objects = {},
                   .tool_radius = world.tool_radius,
                   .T_base_objects = {}};
  for (const TeleopObject& object : world.objects) {
    result.objects.push_back(object.name);
    result.T_base_objects.push_back(object.T_base_object);
  }
  return result;
}

Expected<std::unique_ptr<BlackBox>> open_black_box(const SiteArguments& arguments,
                                                   const SiteScene& scene,
                                                   const Configuration& configuration) {
  if (arguments.log.empty()) return std::unique_ptr<BlackBox>();
  return BlackBox::create(arguments.log, scene, configuration.black_box);
}

void close_black_box(BlackBox* black_box, const std::string& file, const Observer& observer,
                     CommandResult& result) {
  if (black_box == nullptr) return;
  const Expected<BlackBox::Summary> written = black_box->close();
  if (!written)
    return observer.on_warning("the log is not complete: " + written.error().to_string());
  result.summary +=
      fmt::format("log        {} messages, {:.1f} MB, {} records dropped: {}\n", written->messages,
                  1e-6 * static_cast<double>(written->bytes), written->dropped, file);
  result.json["log"] = {{"file", file},
                        {"messages", written->messages},
                        {"bytes", written->bytes},
                        {"dropped", written->dropped}};
}

Expected<std::unique_ptr<Ros2Publisher>> open_publisher(const std::string& file,
                                                        const SiteScene& scene) {
  if (file.empty()) return std::unique_ptr<Ros2Publisher>();
  const Expected<Ros2Publication> publication = read_ros2_publication(file);
  if (!publication) return publication.error();
  Expected<std::unique_ptr<Ros2Publisher>> publisher = Ros2Publisher::create(*publication, scene);
  if (publisher) return publisher;
  Error error = publisher.error();
  if (error.file.empty()) error.file = file;
  return error;
}

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = stop_on_signal;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A closed terminal sends SIGHUP, unless nohup has it ignored.
  struct sigaction hangup {};
  ::sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) ::sigaction(SIGHUP, &action, nullptr);
  return is_stopped;
}

}  // namespace pcavr::app
