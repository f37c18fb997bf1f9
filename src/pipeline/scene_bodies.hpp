// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/object/object_parameters.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene_bundle.hpp"

#include "survey.hpp"

namespace pcavr {

/// The scene's objects, the movable ones first, and their parameters.
struct SceneBodies {
  std::vector<MovableBody> movable;
  std::vector<MovableBody> immovable;
  ParameterTable parameters;
};

/// Reads the scene's CAD bodies at their initial poses, with the recording's tags, and their
/// parameters. Fails where the scene has no object.
[[nodiscard]] Expected<SceneBodies> read_scene_bodies(const Recording& recording,
                                                      const SceneManifest& scene,
                                                      const ReplayOptions& options,
                                                      const Observer& observer);

/// The same, of the movable ones alone and without parameters. Fails where there is none.
[[nodiscard]] Expected<std::vector<MovableBody>> read_movable_bodies(const Recording& recording,
                                                                     const SceneManifest& scene);

/// The movable ones first.
[[nodiscard]] std::vector<MovableBody> all_of(SceneBodies&& bodies);

}  // namespace pcavr
