// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "robots/calibration/rig_fit.hpp"

namespace pcavr {

/// The turn of the camera about the board, from a view that there is, that would reduce the largest
/// std of the camera's position most; the board stays in view, and the flange near where it was in
/// the fitted views. nullopt where none would reduce it by a twentieth.
[[nodiscard]] std::optional<NextPose> plan_next_pose(const std::vector<RigView>& views,
                                                     const std::vector<HandEyeView>& named,
                                                     const RigFit& fit,
                                                     const RigFitOptions& options);

}  // namespace pcavr
