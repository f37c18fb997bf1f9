// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

#include "consistency_observations.hpp"

namespace pcavr {

/// How far base tags, as image and depth measure them, are from where recording.yaml has them, by
/// the camera's estimated poses. Whatever contradicts the rest (lens, depth, stamps, tags) shows
/// here, once the estimate has settled between them. Medians over the views of tags.
struct TagClosure {
  double offset = 0.0;    ///< of a tag's centre [m]
  double distance = 0.0;  ///< from the camera to a tag [m]
  double expected = 0.0;  ///< one std of the offset by poses, depth and print [m]
  std::size_t frames = 0;

  /// More than sound inputs leave.
  [[nodiscard]] bool is_significant() const;
  /// [m] What a std has to contain: none of a usual offset, all of a significant one.
  [[nodiscard]] double doubted() const;
};

/// nullopt where fewer than `min_frames` placed frames measure a base tag.
[[nodiscard]] std::optional<TagClosure> close_tags(const Manifest& manifest,
                                                   const std::vector<TagMeasurement>& measurements,
                                                   const CameraTrack& track,
                                                   const DepthNoise& noise, std::size_t min_frames);

/// What contradicting inputs leave open of the camera's poses, and so of all that it sees: stds to
/// add. The images' noise does not show it.
struct CameraDoubt {
  double position = 0.0;  ///< [m]
  double rotation = 0.0;  ///< [rad]
};

/// What is doubted of the closure, and of the findings about the camera, at the closure's distance.
[[nodiscard]] CameraDoubt doubt_of(const TagClosure& closure,
                                   const std::vector<ConsistencyFinding>& findings);

/// Adds it to the stds of the placed frames.
void widen_by(const CameraDoubt& doubt, CameraTrack& track);

/// The finding of a significant closure: a contradiction where nothing would be where it is drawn.
[[nodiscard]] ConsistencyFinding finding_of(const TagClosure& closure);

}  // namespace pcavr
