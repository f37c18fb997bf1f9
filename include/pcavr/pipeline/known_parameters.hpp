// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/object/object_parameters.hpp"
#include "pcavr/scene/scene_bundle.hpp"

namespace pcavr {

/// The prior parameters of each object of a scene: those given in a parameter file, with
/// the scene's mass where the file has none. `file` names the file in errors: an object that is not
/// in the scene is an Error.
[[nodiscard]] Expected<ParameterTable> known_parameters(const SceneManifest& scene,
                                                        const std::optional<ParameterTable>& given,
                                                        const std::string& file);

}  // namespace pcavr
