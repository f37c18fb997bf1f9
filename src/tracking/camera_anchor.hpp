// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pcavr/geometry/trajectory.hpp"

#include "camera_map.hpp"

namespace pcavr::tracking {

/// A frame's camera in its segment, and what it has seen of base.
struct AnchorSight {
  Pose T_segment_camera;  ///< at the depth stamp
  const FrameRecord* record = nullptr;
};

/// Where a segment lies in base, roughly: each frame's tag pose, its planar twin, and each pose of
/// groundtruth is a hypothesis; the one that all frames together contradict least wins. A twin
/// that fits its own frame is found out by the others. Nothing where no frame saw anything.
[[nodiscard]] std::optional<Pose> anchor_segment(const std::vector<AnchorSight>& sights,
                                                 const std::vector<TagPlacement>& base_tags,
                                                 const Trajectory& groundtruth,
                                                 const CameraModel& camera);

/// Corners of a tag in base, in the order of TagDetection::corners; nothing if it isn't a base tag.
[[nodiscard]] std::optional<std::array<Eigen::Vector3d, 4>> corners_in_base(
    const std::vector<TagPlacement>& base_tags, const MarkerId& id);

}  // namespace pcavr::tracking
