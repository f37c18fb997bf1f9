// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/pipeline/consistency.hpp"

#include "consistency_layout.hpp"
#include "consistency_observations.hpp"
#include "tags_in_view.hpp"

namespace pcavr {

/// Observations in some of a recording's frames.
struct InspectedFrames {
  ConsistencyObservations observations;
  std::vector<TagPairCheck> pairs;
  std::vector<ConsistencyFinding> copied_tags;
  TagsInView tags;
};

/// Comparisons of the images with other inputs, each with its figure, and what could not be
/// compared: depth, sizes and distances of tags, the camera's model, given camera poses, CAD
/// bodies.
[[nodiscard]] std::vector<InputComparison> compare_images(const Recording& recording,
                                                          const InspectedFrames& seen,
                                                          const CameraTrack& track,
                                                          const ConsistencyOptions& options = {});

[[nodiscard]] InputComparison comparison_of(std::string what, std::string figure,
                                            std::vector<std::string> inputs = {});
[[nodiscard]] InputComparison failed_comparison(std::string what, std::string reason);

}  // namespace pcavr
