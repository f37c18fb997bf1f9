// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"

#include "camera_map.hpp"

namespace pcavr::tracking {

struct SegmentPose {
  int segment = -1;
  Pose T_segment_camera;
};

/// The alignments that the pose graph uses.
struct SelectedLinks {
  std::vector<std::vector<FrameLink>> links;  ///< by record
  std::vector<SegmentPose> keyframes;         ///< their poses by these links
  std::size_t rejected = 0;
};

/// All links, less those between look-alike places: that contradict the given poses of both of
/// their frames by more than five standard deviations and more than usual calibrations do. A single
/// given pose that jumps and returns is an outlier and rejects nothing; neither do given poses that
/// contradict most of the links, as with another unit or convention. Poses whose std is stated
/// (are_pose_stds_stated) are right: what contradicts them by more than that and the alignments'
/// own error is left out.
[[nodiscard]] SelectedLinks select_links(const std::vector<Keyframe>& keyframes,
                                         const std::vector<FrameRecord>& records,
                                         const Trajectory& given,
                                         const CameraTrackerOptions& options);

}  // namespace pcavr::tracking
