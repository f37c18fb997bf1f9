// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

/// [N/m^1.5] of the tool's sphere on the object by both materials [Hertz 1882; paper B, eq. 2, 3];
/// empty where one of them is not stated.
[[nodiscard]] std::optional<double> hertz_stiffness_of(const Manifest& manifest,
                                                       const ObjectEntry& object);

/// The prior parameters of each object of a scene: those given in a parameter file, with
/// the scene's mass where the file has none, and its Hertz stiffness likewise. `file` names the
/// file in errors: an object that is not in the scene is an Error.
[[nodiscard]] Expected<ParameterTable> known_parameters(const SceneManifest& scene,
                                                        const std::optional<ParameterTable>& given,
                                                        const std::string& file);

}  // namespace pcavr
