// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "camera_map.hpp"

namespace pcavr::tracking {

/// A keyframe that may show the same place, with an approximate pose of the frame in it.
struct RelocalisationCandidate {
  std::size_t keyframe = 0;
  Pose T_keyframe_frame;
};

/// Approximate pose of the frame in a keyframe, whatever the motion between them: by ORB features
/// [Rublee et al. 2011] and RANSAC on their 3D points. Nothing if too few agree.
[[nodiscard]] std::optional<Pose> pose_by_features(const Sensor& sensor, const Keyframe& keyframe,
                                                   const FrameView& view);

/// Relocalisation and loop closure: matches the frame to the most similar keyframes outside
/// `excluded_segment` as above, best first. An alignment must verify each of them.
[[nodiscard]] std::vector<RelocalisationCandidate> find_relocalisation_candidates(
    const Sensor& sensor, const std::vector<Keyframe>& keyframes, const FrameView& view,
    int excluded_segment);

}  // namespace pcavr::tracking
