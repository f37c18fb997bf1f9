// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/scene/scene_bundle.hpp"

namespace pcavr {

/// What is known beforehand of each movable object of a scene: what a parameter file told, and the
/// scene's mass where that has none. `file` names it in errors: an object that the scene has not is
/// somebody's slip.
[[nodiscard]] Expected<ParameterTable> known_parameters(const SceneManifest& scene,
                                                        const std::optional<ParameterTable>& told,
                                                        const std::string& file);

}  // namespace pcavr
