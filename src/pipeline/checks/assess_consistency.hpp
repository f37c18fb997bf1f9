// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/pipeline/consistency.hpp"

#include "consistency_checks.hpp"
#include "consistency_layout.hpp"
#include "pipeline/build/survey.hpp"

namespace pcavr {

/// Checks of the CAD bodies alone, before any frame is read; `surfaces` are the bodies'.
[[nodiscard]] std::vector<ConsistencyFinding> check_bodies(
    const Recording& recording, const std::vector<DeclaredBody>& bodies,
    const std::vector<SurfaceQuery>& surfaces, const ConsistencyOptions& options = {});

/// Adds the checks that need frames to the bodies' `findings`; contradictions first. `track` may be
/// empty where nothing was tracked, and `pairs` (compare_tag_pairs) where no tags were compared.
[[nodiscard]] std::vector<ConsistencyFinding> assess_consistency(
    const Recording& recording, const std::vector<DeclaredBody>& bodies,
    const ConsistencyObservations& seen, const CameraTrack& track,
    std::vector<ConsistencyFinding> findings, const ConsistencyOptions& options = {},
    const std::vector<TagPairCheck>& pairs = {});

/// Contradictions first, otherwise in the same order.
[[nodiscard]] std::vector<ConsistencyFinding> sorted(std::vector<ConsistencyFinding> findings);

}  // namespace pcavr
