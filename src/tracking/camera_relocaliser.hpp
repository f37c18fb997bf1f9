// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "camera_map.hpp"

namespace pcavr::tracking {

/// A keyframe that may show the same place, with an approximate pose of the frame in it.
struct RelocalisationCandidate {
  std::size_t keyframe = 0;
  Pose T_keyframe_frame;
};

/// Relocalisation and loop closure: matches the frame to keyframes outside `excluded_segment` by
/// ORB features [Rublee et al. 2011] and RANSAC on their 3D points, best first. To be verified by
/// an alignment.
[[nodiscard]] std::vector<RelocalisationCandidate> find_relocalisation_candidates(
    const Sensor& sensor, const std::vector<Keyframe>& keyframes, const FrameView& view,
    int excluded_segment);

}  // namespace pcavr::tracking
