// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"

#include "camera_map.hpp"

namespace pcavr::tracking {

/// A frame's camera pose in its segment, and its observation of base.
struct AnchorObservation {
  Pose T_segment_camera;  ///< at the depth stamp
  const FrameRecord* record = nullptr;
};

/// Approximate pose of a segment in base: hypotheses are each frame's tag pose, the second solution
/// of its planar ambiguity, and each groundtruth pose; the one with the lowest robust cost over all
/// frames is selected, as by consensus. This resolves the planar ambiguity, because a wrong
/// solution does not fit the other frames. Nothing if no frame observed base.
[[nodiscard]] std::optional<Pose> anchor_segment(const std::vector<AnchorObservation>& observations,
                                                 const std::vector<TagPlacement>& base_tags,
                                                 const Trajectory& groundtruth,
                                                 const CameraModel& camera);

/// Corners of a tag in base, in the order of TagDetection::corners; nothing if it is not a base
/// tag.
[[nodiscard]] std::optional<std::array<Eigen::Vector3d, 4>> corners_in_base(
    const std::vector<TagPlacement>& base_tags, const MarkerId& id);

}  // namespace pcavr::tracking
