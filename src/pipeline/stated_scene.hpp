// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/core/expected.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/scene/scene.hpp"

namespace pcavr {

/// The scene of a recording without images: its bodies stand where the manifest says, movable ones
/// as objects and the others as static mesh, on level planes under the movable ones. Nothing was
/// seen, so nothing else is in it. Fails where the manifest does not state a movable object's pose.
[[nodiscard]] Expected<Scene> stated_scene(const Recording& recording, double voxel_size,
                                           double occupancy_resolution);

}  // namespace pcavr
