// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/perception/texture/view_selection.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// Paints the texture of a scene's levels of detail, and fills its support planes where nothing was
/// seen, from the selected views. The scene stays as it is where
/// options or recording allow neither. Reads its mesh and support planes.
void paint_scene(const Recording& recording, ViewSelection selection, const BuildOptions& options,
                 Scene& scene);

}  // namespace pcavr
