// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/pipeline/consistency.hpp"

#include "consistency_checks.hpp"
#include "survey.hpp"

namespace pcavr {

/// The CAD bodies by themselves, before any frame is read; `surfaces` are the bodies'.
[[nodiscard]] std::vector<ConsistencyFinding> check_bodies(
    const Recording& recording, const std::vector<MovableBody>& bodies,
    const std::vector<SurfaceQuery>& surfaces);

/// All that the frames show, added to `findings` of the bodies; contradictions first. `track` may
/// be empty where nothing was tracked.
[[nodiscard]] std::vector<ConsistencyFinding> assess_consistency(
    const Recording& recording, const std::vector<MovableBody>& bodies,
    const ConsistencyObservations& seen, const CameraTrack& track,
    std::vector<ConsistencyFinding> findings);

/// Contradictions first, otherwise in the same order.
[[nodiscard]] std::vector<ConsistencyFinding> sorted(std::vector<ConsistencyFinding> findings);

}  // namespace pcavr
