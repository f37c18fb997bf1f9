// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/sites/robot_interface.hpp"

namespace pcavr {

struct PluginRobotOptions {
  std::string text = {};                  ///< passed to the plugin
  std::vector<std::string> objects = {};  ///< names of the scene's objects
  double start_timeout = 5.0;             ///< [s] for the tool's first sample
};

/// A robot behind a shared library that exports robot_plugin.h. It runs in this process and in the
/// site's thread: its results are checked, but a plugin that hangs or crashes stops the process. An
/// Error if the file is missing, is not a library, lacks the function or has another ABI, if the
/// robot does not open, or gives no pose of its tool in time.
[[nodiscard]] Expected<std::unique_ptr<RobotInterface>> make_plugin_robot(
    const std::filesystem::path& library, const PluginRobotOptions& options);

}  // namespace pcavr
