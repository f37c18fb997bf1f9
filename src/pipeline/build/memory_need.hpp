// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/pipeline/build_limits.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// An Error where the build would need more than `limits.max_memory`, by the area of the surface
/// that some frames see (docs/scale.md), with voxels and tiles that would not. `poses` are
/// T_base_camera by frame, nothing where unknown.
[[nodiscard]] Expected<void> check_memory(const BuildLimits& limits, const Recording& recording,
                                          const std::vector<std::optional<Pose>>& poses,
                                          const BuildOptions& options);

/// The poses of groundtruth.txt by frame.
[[nodiscard]] std::vector<std::optional<Pose>> stated_poses(const Recording& recording);

}  // namespace pcavr
