// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene_bundle.hpp"

#include "survey.hpp"

namespace pcavr {

/// The first part of a replay: the bodies' poses from a folder where there is one, else from the
/// images, else none.
[[nodiscard]] Expected<Replay> track_bodies(const Recording& recording, const SceneManifest& scene,
                                            const std::vector<MovableBody>& movable,
                                            const ReplayOptions& options, const Observer& observer);

/// Adds bodies that keep their poses after the tracked ones.
void add_immovable(const std::vector<MovableBody>& bodies, Replay& replay);

}  // namespace pcavr
