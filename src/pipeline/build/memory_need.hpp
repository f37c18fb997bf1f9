// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The area of the surface that the frames see [m^2], by some of them: the cubes of a coarse grid
/// in base that contain measured depth. `poses` are T_base_camera by frame, nothing where unknown.
[[nodiscard]] double seen_area(const Recording& recording,
                               const std::vector<std::optional<Pose>>& poses,
                               const BuildOptions& options);

/// Peak memory of a build of so much surface [bytes]: docs/scale.md has the model.
[[nodiscard]] double memory_need(double area, const BuildOptions& options);

/// An Error where the build would need more than `options.max_memory` (0: no limit), with voxels
/// and tiles that would not.
[[nodiscard]] Expected<void> check_memory(const Recording& recording,
                                          const std::vector<std::optional<Pose>>& poses,
                                          const BuildOptions& options);

/// The poses of groundtruth.txt by frame.
[[nodiscard]] std::vector<std::optional<Pose>> stated_poses(const Recording& recording);

}  // namespace pcavr
