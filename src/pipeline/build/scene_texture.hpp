// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/perception/texture/view_selection.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The poses of a movable body in the frames used, by stamp.
using ObjectTrack = std::vector<ObjectObservation>;

/// Paints the textures of a scene's levels of detail and of its bodies, and fills its support
/// planes where nothing was seen, from the selected views. The scene stays as it is where options
/// or recording allow neither. Reads its mesh, support planes and objects; `tracks` are those of
/// the first objects, the others do not move.
void paint_scene(const Recording& recording, ViewSelection selection,
                 const std::vector<ObjectTrack>& tracks, const BuildOptions& options, Scene& scene);

}  // namespace pcavr
