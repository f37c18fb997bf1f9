// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The memory that this process may still take [bytes]: what the machine has available, and the
/// process's own limit (ulimit -v). Empty where neither is known.
[[nodiscard]] std::optional<double> available_memory();

/// Memory of fusion, mesh and cloud at a voxel size [bytes], by the surface that the placed frames
/// show: of some of them, spread over the recording, scaled up; where that exceeds `limit`, of all.
/// An upper bound without a look at the frames, where even that is below `limit`. Frames that do
/// not decode are left out.
[[nodiscard]] double estimate_fusion_memory(const Recording& recording, const CameraTrack& camera,
                                            double voxel_size, double max_depth, double limit);

/// The error where a scene would need more memory than is available, with the voxel size that
/// would do; before fusion begins.
[[nodiscard]] std::optional<Error> too_little_memory(const Recording& recording,
                                                     const CameraTrack& camera, double voxel_size,
                                                     double max_depth);

}  // namespace pcavr
