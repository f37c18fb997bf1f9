// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "page_server.hpp"

#include <filesystem>
#include <iostream>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/serve/certificate.hpp"
#include "pcavr/teleoperation/devices/open_device.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"

#include "shared_files.hpp"
#include "startup_message.hpp"

namespace pcavr::app {
namespace {

namespace fs = std::filesystem;

/// Largest weight of the tool, as a share of the device's force.
constexpr double kMaxWeightShare = 0.5;

/// The page of the installation, or that of the sources.
Expected<fs::path> find_page() {
  fs::path folder = find_shared_folder("viewer", "apps/viewer/dist", "index.html");
  if (!folder.empty()) return folder;
  return Error{
      .message = "the web page is not built",
      .hint = "run npm ci && npm run build in apps/viewer, or give its folder with --page"};
}

Expected<std::optional<TlsFiles>> tls_files(const PageArguments& arguments) {
  if (arguments.certificate.empty() != arguments.key.empty()) {
    return Error{.message = "--certificate and --key must be given together"};
  }
  if (!arguments.key.empty()) return std::optional(TlsFiles{arguments.certificate, arguments.key});
  if (!arguments.with_tls) return std::optional<TlsFiles>();
  Expected<TlsFiles> own = load_or_create_certificate(data_folder());
  if (!own) return own.error();
  return std::optional(std::move(*own));
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

/// Reduces `max_force` to what is left for contacts: the hand feels the tool's weight, too.
Expected<void> carry_tool(const PageArguments& arguments, const Configuration& configuration,
                          double& max_force) {
  if (arguments.device == kPageDevice) return {};
  const double weight = configuration.live.tool.weight();
  if (weight > kMaxWeightShare * max_force) {
    return Error{.message = fmt::format("the tool's weight of {:.3g} N leaves too little of the "
                                        "device's {:.3g} N for contacts",
                                        weight, max_force),
                 .place = "serve.tool.mass",
                 .hint = "give a lighter tool, or the device's force with --max-force"};
  }
  max_force -= weight;
  return {};
}

}  // namespace

Expected<void> prepare_server(PageArguments& arguments, const Configuration& configuration) {
  const bool is_replay = arguments.server.is_replay;
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
  options.is_replay = is_replay;
  options.ends_on_signals = true;
  return check_server(options);
}

Expected<SceneWorld> make_page_world(const SceneManifest& scene,
                                     const std::optional<ParameterTable>& parameters,
                                     std::optional<double> tool_radius,
                                     const PageArguments& arguments,
                                     const Configuration& configuration, const Observer& observer) {
  SceneWorldOptions options = configuration.serve;
  options.world = configuration.teleop.world;
  options.unknown_objects = configuration.teleop.unknown_objects;
  options.parameters = parameters;
  options.parameters_file = arguments.parameters;
  options.tool_radius = tool_radius.value_or(options.tool_radius);
  if (arguments.tool_radius > 0.0) options.tool_radius = arguments.tool_radius;
  if (arguments.device == kPageDevice) options.force.max_force = options.max_shown_force;
  if (arguments.max_force > 0.0) options.force.max_force = arguments.max_force;
  const Expected<void> carried = carry_tool(arguments, configuration, options.force.max_force);
  if (!carried) return carried.error();
  Expected<SceneWorld> world = make_scene_world(scene, options);
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

Expected<std::unique_ptr<Device>> make_device(const PageArguments& arguments,
                                              const Configuration& configuration) {
  if (arguments.device != kPageDevice) return open_device(arguments.device, configuration.devices);
  RemoteDeviceOptions page = configuration.page;
  page.name = kPageDevice;
  return std::unique_ptr<Device>(std::make_unique<RemoteDevice>(page));
}

Expected<std::unique_ptr<LiveArm>> make_arm(const SceneManifest& manifest, const SceneWorld& scene,
                                            const Configuration& configuration) {
  const Expected<std::optional<SceneArm>> arm = read_scene_arm(manifest);
  if (!arm) return arm.error();
  if (!*arm) return std::unique_ptr<LiveArm>();
  return std::make_unique<LiveArm>(make_live_arm(**arm, scene, configuration.arm));
}

Expected<void> print_startup_message(const LiveServer& server, const PageWorld& world,
                                     const PageArguments& arguments, std::size_t triangles) {
  StartupInfo info{
      .addresses = addresses_of(server, arguments.server),
      .port = server.port(),
      .scene = arguments.server.scene,
      .mode = arguments.server.is_replay ? "replay" : "live",
      .device = std::string(world.device_name()),
      .objects = world.names(),
      .triangles = triangles,
      .code = server.pairing_code(),
      .is_terminal = isatty(STDOUT_FILENO) == 1,
      .is_local = server.pairing_code().empty(),
      .has_network = !is_wildcard(arguments.server.host) || !machine_addresses().empty(),
      .is_at_localhost = server.pairing_code().empty() || is_wildcard(arguments.server.host),
      .is_tls = arguments.server.tls.has_value(),
      .host_option = arguments.is_operator_site ? "--page-host" : "--host",
      .takes_certificate = !arguments.is_operator_site};
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

}  // namespace pcavr::app
