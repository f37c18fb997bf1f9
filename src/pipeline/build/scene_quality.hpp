// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/perception/scene/scene.hpp"

#include "survey.hpp"

namespace pcavr {

/// The form that a scene stores.
[[nodiscard]] InputWarning to_warning(const ConsistencyFinding& finding);

/// The scene's quality figures, all but the times. Readings farther than `max_distance` [m] from
/// the mesh are outliers.
[[nodiscard]] SceneQuality assess_quality(const Recording& recording, const Survey& survey,
                                          const Scene& scene, double max_distance);

}  // namespace pcavr
