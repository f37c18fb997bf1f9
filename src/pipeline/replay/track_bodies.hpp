// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "pipeline/build/survey.hpp"

namespace pcavr {

/// The first part of a replay: the bodies' poses from a folder where there is one, else from the
/// images, else none.
[[nodiscard]] Expected<Replay> track_bodies(const Recording& recording, const SceneManifest& scene,
                                            const std::vector<DeclaredBody>& movable,
                                            const ReplayOptions& options, const Observer& observer);

/// Adds bodies that keep their poses after the tracked ones.
void add_immovable(const std::vector<DeclaredBody>& bodies, Replay& replay);

}  // namespace pcavr
