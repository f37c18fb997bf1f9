// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/scene/scene.hpp"

#include "survey.hpp"

namespace pcavr {

/// Adds to the stds of the pose of a body (by its index) what contradicting inputs leave open: base
/// tags that are elsewhere by the camera's poses, its own tags that disagree, and depth that has it
/// elsewhere. The images' noise, of which its stds are, shows none of them.
void widen_by_doubts(const Manifest& manifest, const Survey& survey, std::size_t body,
                     const Trajectory& camera, SceneObject& object);

}  // namespace pcavr
