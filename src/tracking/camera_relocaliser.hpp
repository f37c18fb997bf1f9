// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera_map.hpp"

namespace pcavr::tracking {

/// A keyframe that may show the same place, and roughly how the frame lies in it.
struct RelocalisationStart {
  std::size_t keyframe = 0;
  Pose T_keyframe_frame;
};

/// Looks for the frame's place among the keyframes that are not of `segment_left_out`, by ORB
/// features [Rublee et al. 2011] and their points in space, best first. To be checked by an
/// alignment.
[[nodiscard]] std::vector<RelocalisationStart> find_relocalisation_starts(
    const Sensor& sensor, const std::vector<Keyframe>& keyframes, const FrameView& view,
    int segment_left_out);

}  // namespace pcavr::tracking
