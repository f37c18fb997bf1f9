// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

namespace pcavr {

/// The input of both sites, as replay_recording() makes it: the scene's objects with their
/// parameters and tracking, the tool's motion and the force, in seconds from the recording's start.
[[nodiscard]] Expected<TeleopInput> read_teleop_input(const Recording& recording,
                                                      const SceneManifest& scene,
                                                      const ReplayOptions& options,
                                                      const Observer& observer = {});
/// The same without a recording: objects and static surface.
[[nodiscard]] Expected<TeleopInput> read_teleop_world(const SceneManifest& scene,
                                                      const ReplayOptions& options,
                                                      const Observer& observer = {});
/// Adds a recording's tool motion, in seconds from its start, and the tool's radius.
void add_tool_motion(const Recording& recording, TeleopInput& input);

}  // namespace pcavr
