// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "pipeline/robot/recorded_arm.hpp"
#include "survey.hpp"

namespace pcavr {

/// A frame with a camera pose, every movable object's pose, and a mask of the dynamic pixels.
struct FollowedFrame {
  RgbdFrame frame;
  Pose T_base_camera;
  std::vector<ObjectObservation> objects;  ///< in the order of the bodies
  MaskImage is_dynamic;                    ///< of the depth image's size
};

/// The name that is written to files: "tags_and_shape", "tags", "shape", "not_seen".
[[nodiscard]] const char* evidence_name(ObjectEvidence evidence);

/// The maximum number of samples for each of so many tracked bodies, up to `max_samples`: bounds
/// the work per frame.
[[nodiscard]] int samples_per_body(std::size_t bodies, int max_samples);

/// Second pass: reads the frames again with the camera's final poses, tracks the movable bodies by
/// tags and shape, and masks them, the arm and the tool. Calls `use` for each frame with a camera
/// pose, in order, while the next one is prefetched on a second thread. `arm` may be null.
[[nodiscard]] Expected<void> follow_objects(const Recording& recording,
                                            const std::vector<DeclaredBody>& bodies,
                                            const Survey& survey, const SurveyOptions& options,
                                            const Observer& observer,
                                            const std::function<void(const FollowedFrame&)>& use,
                                            const RecordedArm* arm = nullptr);

}  // namespace pcavr
