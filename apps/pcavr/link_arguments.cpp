// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "link_arguments.hpp"

#include <csignal>
#include <limits>
#include <utility>

#include "pcavr/object/parameters_file.hpp"
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
                   .tool_radius = world.tool_radius};
  for (const TeleopObject& object : world.objects) result.objects.push_back(object.name);
  return result;
}

const std::atomic<bool>& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = stop_on_signal;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  return is_stopped;
}

}  // namespace pcavr::app
