// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "survey_reasons.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/core.h>

#include "pipeline/checks/assess_consistency.hpp"

namespace pcavr {
namespace {

/// The finding that a base tag is in view twice; nothing where none is.
std::optional<ConsistencyFinding> copied_base_tag(const Manifest& manifest, const Survey& survey) {
  for (std::size_t i = 0; i < manifest.markers.size(); ++i) {
    const MarkerEntry& marker = manifest.markers[i];
    if (marker.role != MarkerRole::base || !survey.copied_tags.contains(marker.id)) continue;
    for (const ConsistencyFinding& finding : survey.findings) {
      if (finding.place == fmt::format("markers[{}]", i)) return finding;
    }
  }
  return std::nullopt;
}

/// Counts of how often a body's tags were detected, and how often they gave no pose.
struct TagOutcome {
  std::set<std::string> names;
  std::size_t frames = 0;
  std::size_t rejected = 0;  ///< of these, frames without a pose that fits the tags
};

TagOutcome outcome_of_tags(const std::vector<TagPlacement>& placements,
                           const std::vector<std::vector<TagDetection>>& seen,
                           const CameraModel& camera, const BodyPoseOptions& options) {
  TagOutcome outcome;
  for (const std::vector<TagDetection>& detections : seen) {
    const BodyPose pose = solve_body_pose(placements, detections, camera, {}, options);
    if (pose.status == BodyPoseStatus::not_seen) continue;
    ++outcome.frames;
    outcome.rejected += pose.status == BodyPoseStatus::failed ? 1 : 0;
    for (const TagDetection& detection : detections) {
      for (const TagPlacement& placement : placements) {
        if (placement.id == detection.id) outcome.names.insert(detection.id.to_string());
      }
    }
  }
  return outcome;
}

}  // namespace

Error not_placed_error(const Recording& recording, const Survey& survey,
                       const PerceptionOptions& options) {
  const std::string file = (recording.folder / "recording.yaml").string();
  if (const auto copied = copied_base_tag(recording.manifest, survey)) {
    return {.message = "no frame could be placed in base: " + copied->message,
            .file = file,
            .place = copied->place,
            .hint = copied->hint};
  }
  const bool has_anchor =
      std::any_of(recording.manifest.markers.begin(), recording.manifest.markers.end(),
                  [&](const MarkerEntry& marker) {
                    return marker.role == MarkerRole::base && survey.tags_seen.count(marker.id) > 0;
                  });
  if (has_anchor || !recording.groundtruth.empty()) {
    const std::string rejected =
        explain_rejected_tags(recording, survey.detections, "", options.body_pose);
    EmptySceneCause cause{survey.camera.failure_reason, ""};
    if (recording.has_depth && is_out_of_range(survey.depth)) {
      cause = explain_empty_scene(survey.depth, options.depth_noise, recording.manifest.depth_scale,
                                  {}, 1.0);
    }
    if (!rejected.empty()) cause = {rejected, kRejectedTagsHint};
    return {.message = "no frame could be placed in base: " + cause.message,
            .file = file,
            .hint = cause.hint};
  }
  std::string seen;
  for (const auto& [id, frames] : survey.tags_seen) {
    seen +=
        (seen.empty() ? "" : ", ") + id.to_string() + " (" + std::to_string(frames) + " frames)";
  }
  return {.message =
              "no base tag was seen in any frame, and there is no groundtruth.txt; tags "
              "seen: " +
              (seen.empty() ? "none" : seen),
          .file = file,
          .place = "markers",
          .hint = "declare a tag that is in view with role: base, its size and its pose"};
}

std::string explain_rejected_tags(const Recording& recording,
                                  const std::vector<std::vector<TagDetection>>& seen,
                                  const std::string& object, const BodyPoseOptions& options) {
  const std::vector<TagPlacement> placements = object.empty()
                                                   ? base_placements(recording.manifest)
                                                   : object_placements(recording.manifest, object);
  const TagOutcome outcome = outcome_of_tags(placements, seen, *recording.manifest.camera, options);
  if (outcome.rejected == 0) return {};
  std::string names;
  for (const std::string& name : outcome.names) names += (names.empty() ? "" : ", ") + name;
  return names + (outcome.names.size() == 1 ? " was" : " were") + " seen in " +
         std::to_string(outcome.frames) + " frames, but rejected in " +
         std::to_string(outcome.rejected) + ": no pose of a square fits the detected corners";
}

std::string explain_not_found(const Recording& recording, const Survey& survey,
                              const DeclaredBody& body, const BodyPoseOptions& options) {
  if (body.tags.empty()) return "it has no tag, and no pose in recording.yaml";
  const std::string rejected =
      explain_rejected_tags(recording, survey.detections, body.entry.name, options);
  if (!rejected.empty()) return rejected;
  std::string reason;
  for (const TagPlacement& tag : body.tags) {
    const bool is_copied = survey.copied_tags.contains(tag.id);
    const auto seen = survey.tags_seen.find(tag.id);
    reason += (reason.empty() ? "its tag " : ", ") + tag.id.to_string() +
              (is_copied                        ? " is in view twice"
               : seen == survey.tags_seen.end() ? " is in no frame"
                                                : " is in no frame that was placed");
  }
  return reason;
}

}  // namespace pcavr
