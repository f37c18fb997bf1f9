// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/recording/frame_reader.hpp"
#include "pcavr/tracking/object_tracker.hpp"

#include "survey.hpp"

namespace pcavr {

/// A placed frame, with every movable object's pose in it and what shows no static scene masked.
struct FollowedFrame {
  RgbdFrame frame;
  Pose T_base_camera;
  std::vector<ObjectObservation> objects;  ///< as the bodies are ordered
  MaskImage is_dynamic;                    ///< of the depth image's size
};

/// As written into files: "tags_and_shape", "tags", "shape", "not_seen".
[[nodiscard]] const char* evidence_word(ObjectEvidence evidence);

/// ObjectTrackerOptions::max_samples where so many bodies are followed: work per frame is bounded.
[[nodiscard]] int samples_per_body(std::size_t bodies);

/// Second pass: goes through the frames again with the camera's final poses, follows the movable
/// bodies by tags and shape, and masks them and the tool's tip. Calls `use` for each placed frame
/// in order, while the next one is being prepared on a second thread.
[[nodiscard]] Expected<void> follow_objects(const Recording& recording,
                                            const std::vector<MovableBody>& bodies,
                                            const Survey& survey, const SurveyOptions& options,
                                            const Observer& observer,
                                            const std::function<void(const FollowedFrame&)>& use);

}  // namespace pcavr
