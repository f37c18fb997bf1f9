// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/perception/texture/texture_options.hpp"
#include "pcavr/perception/texture/view_selection.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The poses of a movable body in the frames used, by stamp.
using ObjectTrack = std::vector<ObjectObservation>;

/// How the texels of a scene are shared: `atlas_width` x `atlas_height` at most, for the static
/// mesh and all bodies together, so that the memory of a headset's graphics card has a bound.
struct TextureShares {
  int scene_height = 0;         ///< [px] of the static mesh's texture, of `atlas_width`
  int max_body_edge = 0;        ///< [px] of each body's texture; 0: bodies have none
  std::size_t body_texels = 0;  ///< of all bodies; bodies beyond have their plain colour
};

/// `bodies`: the number of those that were seen.
[[nodiscard]] TextureShares texture_shares(std::size_t bodies, const TextureOptions& options);

/// Paints the textures of a scene's levels of detail and of its bodies, and fills its support
/// planes where nothing was seen, from the selected views. The scene stays as it is where options
/// or recording allow neither. Reads its mesh, support planes and objects; `tracks` are those of
/// the first objects, the others do not move.
void paint_scene(const Recording& recording, ViewSelection selection,
                 const std::vector<ObjectTrack>& tracks, const BuildOptions& options, Scene& scene);

}  // namespace pcavr
