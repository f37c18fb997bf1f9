// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/perception/marker/tag_pair.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/pipeline/consistency.hpp"

namespace pcavr {

/// Two tags of one body (base or an object): where recording.yaml puts one relative to the other,
/// and where the images that show both do.
struct TagPairCheck {
  std::size_t first = 0;  ///< in Manifest::markers
  std::size_t second = 0;
  Pose T_first_second_stated;
  Pose T_first_second;          ///< by the images
  double distance_std = 0.0;    ///< of the distance of the two by the images [m]
  double offset = 0.0;          ///< between the two places of the second tag [m]
  double rotation = 0.0;        ///< likewise [rad]
  double excess = 0.0;          ///< normalised by the images' noise alone: 1 is usual
  bool is_significant = false;  ///< more than noise and errors of printing and mounting explain
  std::size_t frames = 0;

  [[nodiscard]] double distance() const { return T_first_second.translation().norm(); }
  [[nodiscard]] double stated_distance() const {
    return T_first_second_stated.translation().norm();
  }
};

/// Compares the tags of each body that are in view together in at least `min_frames` frames: all
/// pairs of up to four tags; of more, each with its three nearest.
[[nodiscard]] std::vector<TagPairCheck> compare_tag_pairs(
    const Manifest& manifest, const std::vector<std::vector<TagDetection>>& detections,
    std::size_t min_frames, const BodyPoseOptions& options = {});

/// The pairs that disagree. Where one tag disagrees with several that agree with each other, it is
/// named alone; otherwise both of the pair are.
[[nodiscard]] std::vector<ConsistencyFinding> check_tag_layout(
    const Manifest& manifest, const std::vector<TagPairCheck>& pairs,
    const ConsistencyOptions& options = {});

/// Adds to the camera's stated stds what disagreeing base tags leave open: the tags' own noise does
/// not show it.
void widen_by_layout(const Manifest& manifest, const std::vector<TagPairCheck>& pairs,
                     CameraTrack& track);

/// What disagreeing tags of one body leave open of its pose.
struct LayoutDoubt {
  double offset = 0.0;    ///< [m]
  double rotation = 0.0;  ///< [rad]
};
/// Zero where its tags agree, and of a body with one tag.
[[nodiscard]] LayoutDoubt layout_doubt(const Manifest& manifest,
                                       const std::vector<TagPairCheck>& pairs,
                                       const std::string& object);

}  // namespace pcavr
