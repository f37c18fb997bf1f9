// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/scene/scene.hpp"

#include "survey.hpp"

namespace pcavr {

/// As a scene keeps it.
[[nodiscard]] InputWarning to_warning(const ConsistencyFinding& finding);

/// The figures by which a person can judge a scene; all but the times.
[[nodiscard]] SceneQuality assess_quality(const Recording& recording, const Survey& survey,
                                          const Scene& scene);

}  // namespace pcavr
