// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "pipeline/build/scene_bodies.hpp"

namespace pcavr {

/// The input of both sites from what was read and tracked, in seconds from the recording's start.
[[nodiscard]] Expected<TeleopInput> assemble_teleop_input(const Recording& recording,
                                                          const SceneManifest& scene,
                                                          SceneBodies&& bodies,
                                                          const Replay& replay);

}  // namespace pcavr
