// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"

namespace pcavr {

/// Warnings for a user about the camera's poses: which frames are left out, and what places them;
/// which given poses the images contradict. One sentence each; empty where all is well. Frames by
/// their index, from 0.
[[nodiscard]] std::vector<std::string> placement_warnings(const CameraTrack& track,
                                                          const Trajectory& given,
                                                          const CameraTrackerOptions& options);

/// The error where half of the placed frames are known so badly that no scene could be built of
/// them, such as those of views that look alike. `recording`: its folder.
[[nodiscard]] std::optional<Error> undetermined_camera(const CameraTrack& track,
                                                       const std::filesystem::path& recording);

/// The error where tags and images put a frame more than 5 stds from a given pose whose std is
/// stated (are_pose_stds_stated): names the frames, by how much, and what contradicts. Empty where
/// they don't, and with `trust_poses`.
[[nodiscard]] std::optional<Error> moved_poses(const CameraTrack& track, const Trajectory& given,
                                               const CameraTrackerOptions& options,
                                               const std::filesystem::path& recording);

}  // namespace pcavr
