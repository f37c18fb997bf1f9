// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/serve/viewer_scene.hpp"

namespace pcavr {

struct ReplayLogOptions {
  /// [Hz] of predicted poses and of the forces: of the operator's 1 kHz, as in a site's black box.
  double rate = 100.0;
  bool replace = false;  ///< an existing MCAP file
};

/// Whether write_replay_log() could write there; for use before a long computation.
[[nodiscard]] Expected<void> check_replay_log(const std::filesystem::path& file, bool replace);

/// Writes a replay as an MCAP file with the channels that viewers get from a live site
/// (docs/live-protocol.md), as ROS 2 messages by the recording's clock, in order of time: geometry
/// and parameters once, at the start. `replay` must hold all of its run (no run_folder), and
/// `recording` what it was made of; `joints` of read_scene_joints. Returns the number of messages.
/// Errors: an image that can't be read, a file that can't be written. Deterministic.
[[nodiscard]] Expected<std::uint64_t> write_replay_log(const std::filesystem::path& file,
                                                       const Recording& recording,
                                                       const Replay& replay,
                                                       const ViewerScene& scene,
                                                       const ReplayLogOptions& options = {},
                                                       const std::optional<JointLog>& joints = {});

}  // namespace pcavr
