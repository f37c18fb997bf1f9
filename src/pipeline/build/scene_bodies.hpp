// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "survey.hpp"

namespace pcavr {

/// The scene's objects, the movable ones first, and their parameters.
struct SceneBodies {
  std::vector<DeclaredBody> movable;
  std::vector<DeclaredBody> immovable;
  ParameterTable parameters;
};

/// Reads the scene's CAD bodies at their initial poses, with the recording's tags, and their
/// parameters. Fails where the scene has no object.
[[nodiscard]] Expected<SceneBodies> read_scene_bodies(const Recording& recording,
                                                      const SceneManifest& scene,
                                                      const ReplayOptions& options,
                                                      const Observer& observer);

/// The same, of the movable ones alone and without parameters. Fails where there is none.
[[nodiscard]] Expected<std::vector<DeclaredBody>> read_movable_bodies(const Recording& recording,
                                                                      const SceneManifest& scene);

/// The movable ones first.
[[nodiscard]] std::vector<DeclaredBody> all_of(SceneBodies&& bodies);

}  // namespace pcavr
