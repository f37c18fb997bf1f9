// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "pcavr/pipeline/replay.hpp"
#include "pcavr/teleoperation/link/link_keys.hpp"
#include "pcavr/teleoperation/ros2/ros2_publisher.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"

#include "commands.hpp"

namespace pcavr::app {

/// Arguments that robot-site and operator-site have in common.
struct SiteArguments {
  std::string scene;
  std::string recording;
  std::string tracked;
  std::string parameters;
  std::string host = "127.0.0.1";
  std::uint16_t port = 5670;
  std::string key;      ///< file
  std::string log;      ///< file
  std::string publish;  ///< file: a setup of ROS 2 topics
};
void add_site_options(CLI::App& command, SiteArguments& arguments);

/// The keys of --key; nothing without it.
[[nodiscard]] Expected<std::optional<LinkKeys>> keys_of(const SiteArguments& arguments);

/// The options of a replay that both sites use.
[[nodiscard]] Expected<ReplayOptions> site_options(const SiteArguments& arguments,
                                                   const Configuration& configuration);
[[nodiscard]] SiteScene site_scene_of(const SceneManifest& scene, const TeleopInput& world);

/// The black box of --log; null without it.
[[nodiscard]] Expected<std::unique_ptr<BlackBox>> open_black_box(
    const SiteArguments& arguments, const SiteScene& scene, const Configuration& configuration);
/// Closes it, and adds to the site's result what it contains. A failure to write is a warning: the
/// site's result is worth more.
void close_black_box(BlackBox* black_box, const std::string& file, const Observer& observer,
                     CommandResult& result);

/// What publishes the predictions as the file says; null without one.
[[nodiscard]] Expected<std::unique_ptr<Ros2Publisher>> open_publisher(const std::string& file,
                                                                      const SiteScene& scene);

/// Becomes true with SIGINT or SIGTERM, from then on.
[[nodiscard]] const std::atomic<bool>& stop_on_signals();

}  // namespace pcavr::app
