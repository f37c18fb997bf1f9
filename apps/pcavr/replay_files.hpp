// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/pipeline/replay.hpp"

#include "commands.hpp"

namespace pcavr::app {

/// Single files that replay makes of its run, beside the run's folder. Empty names: none.
struct ReplayFiles {
  std::string video;
  std::string html;
  std::string mcap;
  double html_size = 8.0;  ///< [MB]
  bool replace = false;    ///< by --force

  [[nodiscard]] std::vector<std::string> names() const;
  /// Whether they need the recording's tool motion and wrench, after both sites have run.
  [[nodiscard]] bool need_recording() const { return !names().empty(); }
  /// Whether they need all of the run in memory.
  [[nodiscard]] bool need_run() const { return !html.empty() || !mcap.empty(); }
};

void add_replay_files(CLI::App& command, ReplayFiles& files);

/// What the files are made of.
struct ReplayInput {
  const Recording& recording;
  const SceneManifest& scene;
  const ReplayOptions& options;
  const Configuration& configuration;
};

/// Checks before the long work whether the files can be made.
[[nodiscard]] Expected<void> check_replay_files(const ReplayFiles& files,
                                                const Recording& recording);
/// Writes the files, and adds them to the result.
[[nodiscard]] Expected<void> write_replay_files(const ReplayFiles& files, const ReplayInput& input,
                                                const Replay& run, const Observer& observer,
                                                CommandResult& result);

}  // namespace pcavr::app
