// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "declared_bodies.hpp"
#include "pipeline/checks/consistency_layout.hpp"
#include "pipeline/checks/consistency_observations.hpp"
#include "pipeline/checks/tag_closure.hpp"

namespace pcavr {

struct SurveyOptions {
  PerceptionOptions perception = {};
  bool trust_poses = false;
  bool skip_bad = false;
  Parallelism parallelism = {};
};

/// Results of the first pass over the frames.
struct Survey {
  std::vector<std::vector<TagDetection>> detections;  ///< by index in Recording::frames
  CameraTrack camera;
  /// Pose of each body at its first detection, from its tags alone; by body.
  std::vector<std::optional<Pose>> T_base_object_first;
  std::map<MarkerId, std::size_t> tags_seen;  ///< frames in which each declared tag was seen
  /// Of these, the ones that are not used because their id is in view twice.
  std::set<MarkerId> copied_tags = {};
  std::size_t undecoded = 0;  ///< left out by skip_bad
  DepthSummary depth;
  /// In the stds of the camera's poses already; zero where these are given as exact.
  CameraDoubt camera_doubt = {};
  std::vector<TagPairCheck> pairs = {};  ///< tags of one body, as far as they are seen together
  /// How far depth has each body from where its tags put it [m]; by body.
  std::vector<double> body_shifts = {};
  std::vector<ConsistencyFinding> findings;  ///< warnings: a contradiction is an Error
};

/// Finds the manifest's tags; nothing where it names none.
[[nodiscard]] Expected<std::optional<TagDetector>> make_tag_detector(const Recording& recording,
                                                                     TagDetectorOptions options);

/// The hint where tags were rejected.
inline constexpr char kRejectedTagsHint[] = "check fx, fy, cx, cy and the tags' sizes and poses";
/// Why the tags of a body (base, where `object` is empty) gave no pose although they were detected:
/// "tag36h11:0 was seen in 38 frames, but ...". Empty where they were not
/// detected, or gave a pose.
[[nodiscard]] std::string explain_rejected_tags(const Recording& recording,
                                                const std::vector<std::vector<TagDetection>>& seen,
                                                const std::string& object,
                                                const BodyPoseOptions& options = {});

/// Why a body was not found: what its tags showed.
[[nodiscard]] std::string explain_not_found(const Recording& recording, const Survey& survey,
                                            const DeclaredBody& body,
                                            const BodyPoseOptions& options = {});

/// First pass: finds the tags, and the camera's pose in base for every frame, unless it is known
/// already, and cross-checks the inputs. An Error where they contradict each other
/// (consistency.hpp), and where no frame can be placed.
[[nodiscard]] Expected<Survey> survey_recording(const Recording& recording,
                                                const std::vector<DeclaredBody>& bodies,
                                                const SurveyOptions& options,
                                                const Observer& observer,
                                                std::optional<CameraTrack> known_camera = {});

/// Why frames were not used, with counts; reasons that do not occur are omitted.
[[nodiscard]] std::vector<std::pair<std::string, std::size_t>> dropped_frames(
    const Recording& recording, const Survey& survey);

}  // namespace pcavr
