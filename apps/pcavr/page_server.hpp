// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/serve/page_world.hpp"
#include "pcavr/serve/scene_arm.hpp"
#include "pcavr/serve/scene_world.hpp"
#include "pcavr/serve/server.hpp"
#include "pcavr/teleoperation/devices/device.hpp"

#include "commands.hpp"

namespace pcavr::app {

inline constexpr char kPageDevice[] = "page";

/// Arguments that serve and operator-site have in common: a page, and what moves its tool.
struct PageArguments {
  std::string parameters;
  std::string page;  ///< folder
  std::string device = kPageDevice;
  std::string certificate;
  std::string key;  ///< of the certificate
  bool with_tls = false;
  double tool_radius = 0.0;  ///< [m]; 0: not given
  double max_force = 0.0;    ///< [N]; 0: not given
  ServerOptions server;      ///< the configuration's, completed by prepare_server
  bool as_json = false;
  bool is_operator_site = false;  ///< its --host and --key are those of the link
};

/// Completes arguments.server but for the scene's, and checks whether it could be opened now.
[[nodiscard]] Expected<void> prepare_server(PageArguments& arguments,
                                            const Configuration& configuration);
[[nodiscard]] Expected<SceneWorld> make_page_world(const SceneManifest& scene,
                                                   const std::optional<ParameterTable>& parameters,
                                                   std::optional<double> tool_radius,
                                                   const PageArguments& arguments,
                                                   const Configuration& configuration,
                                                   const Observer& observer);
[[nodiscard]] Expected<std::unique_ptr<Device>> make_device(const PageArguments& arguments,
                                                            const Configuration& configuration);
/// Null where the scene has no arm.
[[nodiscard]] Expected<std::unique_ptr<LiveArm>> make_arm(const SceneManifest& manifest,
                                                          const SceneWorld& scene,
                                                          const Configuration& configuration);
[[nodiscard]] Expected<void> print_startup_message(const LiveServer& server, const PageWorld& world,
                                                   const PageArguments& arguments,
                                                   std::size_t triangles);

}  // namespace pcavr::app
