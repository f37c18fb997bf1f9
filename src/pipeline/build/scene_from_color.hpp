// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The scene of a recording in colour alone: camera and bodies are placed by their tags (bodies
/// that are not seen at their stated poses), with horizontal support planes under the movable ones.
/// There are no surfaces.
[[nodiscard]] Expected<Scene> scene_from_color(const Recording& recording,
                                               const BuildOptions& options,
                                               const Observer& observer);

}  // namespace pcavr
