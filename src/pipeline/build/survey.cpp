// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "survey.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "body_masker.hpp"
#include "pipeline/checks/assess_consistency.hpp"
#include "pipeline/checks/tag_closure.hpp"
#include "pipeline/checks/tag_copies.hpp"
#include "placement_warnings.hpp"
#include "prefetcher.hpp"
#include "survey_reasons.hpp"

namespace pcavr {
namespace {

/// A frame and its tag detections.
struct DetectedFrame {
  std::optional<RgbdFrame> frame;  ///< empty after the last one
  std::vector<TagDetection> detections = {};
  std::vector<MarkerId> seen_twice = {};  ///< left out of the detections
  bool has_depth = false;
};

std::vector<std::string> families_of(const Manifest& manifest) {
  std::set<std::string> families;
  for (const MarkerEntry& marker : manifest.markers) families.insert(marker.id.family);
  return {families.begin(), families.end()};
}

/// The first detections, transformed to base by the camera's final poses.
std::vector<std::optional<Pose>> first_poses(
    const std::vector<std::optional<FirstDetection>>& detections, const CameraTrack& camera) {
  std::vector<std::optional<Pose>> poses(detections.size());
  for (std::size_t i = 0; i < detections.size(); ++i) {
    for (const FramePlacement& placement : camera.frames) {
      if (!detections[i] || placement.frame != detections[i]->frame) continue;
      if (placement.status != PlacementStatus::placed) continue;
      poses[i] = placement.T_base_camera * detections[i]->T_camera_body;
    }
  }
  return poses;
}

Error no_depth_error(const Recording& recording) {
  return {.message = "no depth image has a measurement",
          .file = (recording.folder / "depth.txt").string(),
          .hint = "check the sensor, and that the images are 16-bit depth"};
}

/// What the camera's poses leave open at the base tags: widens their stds, and names it where no
/// other finding does. What would displace the scene as a whole is a contradiction.
void use_closure(const Recording& recording, const ConsistencyObservations& seen,
                 const DepthNoise& noise, Survey& survey) {
  const std::size_t min_frames = std::min(kMinFindingFrames, recording.frames.size());
  const std::optional<TagClosure> closure =
      close_tags(recording.manifest, seen.tags, survey.camera, noise, min_frames);
  if (!closure) return;
  survey.camera_doubt = doubt_of(*closure, survey.findings);
  widen_by(survey.camera_doubt, survey.camera);
  if (!closure->is_significant()) return;
  const ConsistencyFinding finding = finding_of(*closure);
  const bool is_contradiction = finding.severity == FindingSeverity::contradiction;
  if (!survey.findings.empty() && !is_contradiction) return;
  // Behind those that name a cause: the first one is what a user reads.
  const auto place = std::find_if(survey.findings.begin(), survey.findings.end(),
                                  [](const ConsistencyFinding& other) {
                                    return other.severity != FindingSeverity::contradiction;
                                  });
  survey.findings.insert(place, finding);
}

}  // namespace

Expected<std::optional<TagDetector>> make_tag_detector(const Recording& recording,
                                                       TagDetectorOptions options) {
  const std::vector<std::string> families = families_of(recording.manifest);
  if (families.empty()) return std::optional<TagDetector>();
  if (recording.manifest.camera->has_distortion()) options.lens = recording.manifest.camera;
  Expected<TagDetector> detector = TagDetector::create(families, options);
  if (!detector) {
    Error error = detector.error();
    error.file = (recording.folder / "recording.yaml").string();
    return error;
  }
  return std::optional<TagDetector>(std::move(*detector));
}

Expected<Survey> survey_recording(const Recording& recording,
                                  const std::vector<DeclaredBody>& bodies,
                                  const SurveyOptions& options, const Observer& observer,
                                  std::optional<CameraTrack> known_camera) {
  const PerceptionOptions& perception = options.perception;
  Expected<std::optional<TagDetector>> detector =
      make_tag_detector(recording, perception.tag_detector);
  if (!detector) return detector.error();
  FrameReader reader(recording, {.skip_bad = options.skip_bad});
  const auto detect_next = [&]() -> Expected<DetectedFrame> {
    Expected<std::optional<RgbdFrame>> frame = reader.next();
    if (!frame) return frame.error();
    DetectedFrame detected{.frame = std::move(*frame)};
    if (detected.frame && *detector) {
      detected.detections = (*detector)->detect(to_gray(detected.frame->color));
      detected.seen_twice = (*detector)->seen_twice();
    }
    if (detected.frame) {
      detected.has_depth =
          std::any_of(detected.frame->depth.pixels().begin(), detected.frame->depth.pixels().end(),
                      [](float z) { return z > 0.0F; });
    }
    return detected;
  };
  const auto is_last = [](const Expected<DetectedFrame>& item) { return !item || !item->frame; };

  const CameraModel& camera = *recording.manifest.camera;
  CameraTrackerOptions tracker_options = camera_options(perception);
  // Nothing could correct given poses without depth.
  const bool has_poses = !recording.groundtruth.empty();
  tracker_options.trust_poses = options.trust_poses || (!recording.has_depth && has_poses);
  CameraTracker tracker(recording.manifest, recording.groundtruth, tracker_options);
  // Masks of dynamic pixels are needed only where the camera is tracked.
  const bool needs_masks = !known_camera && !tracker_options.trust_poses && recording.has_depth;
  BodyMasker masker(bodies, camera, perception, needs_masks);
  Survey survey;
  survey.findings = check_bodies(recording, bodies, masker.surfaces(), perception.consistency);
  if (has_contradiction(survey.findings)) return contradiction_error(recording, survey.findings);
  ConsistencyCollector collector(recording.manifest, perception.depth_noise, masker.surfaces(),
                                 recording.frames.size());
  survey.detections.resize(recording.frames.size());
  TagCopies copies;
  bool any_depth = false;
  Prefetcher prefetcher(detect_next, options.parallelism);
  while (true) {
    Expected<DetectedFrame> detected = prefetcher.take(is_last);
    if (!detected) return detected.error();
    if (!detected->frame) break;
    const RgbdFrame& frame = *detected->frame;
    any_depth = any_depth || detected->has_depth;
    for (const TagDetection& tag : detected->detections) ++survey.tags_seen[tag.id];
    for (const MarkerId& id : detected->seen_twice) ++survey.tags_seen[id];
    copies.add(detected->detections, detected->seen_twice);
    const MaskImage is_dynamic =
        masker.mask(frame, detected->detections, collector.needs_body_poses_next());
    collector.add(frame, detected->detections, masker.last_poses());
    if (!known_camera) tracker.add(frame, detected->detections, is_dynamic, options.parallelism);
    survey.detections[frame.index] = std::move(detected->detections);
    observer.on_progress("detecting tags", frame.index + 1, recording.frames.size());
  }
  survey.undecoded = reader.skipped();
  if (recording.has_depth && !any_depth) return no_depth_error(recording);
  for (ConsistencyFinding& finding : copies.findings(recording.manifest)) {
    survey.findings.push_back(std::move(finding));
  }
  survey.copied_tags = copies.ids();
  for (std::vector<TagDetection>& detections : survey.detections) {
    remove_tags(survey.copied_tags, detections);
  }
  tracker.ignore_tags(survey.copied_tags);
  collector.ignore_tags(survey.copied_tags, bodies_with_tags(bodies, survey.copied_tags));
  masker.ignore_tags(survey.copied_tags, survey.detections);

  survey.camera = known_camera ? std::move(*known_camera) : tracker.solve(observer);
  survey.depth = collector.observations().depth;
  survey.pairs =
      compare_tag_pairs(recording.manifest, survey.detections,
                        std::min(kMinFindingFrames, recording.frames.size()), perception.body_pose);
  for (const OutlineFit& outline : collector.observations().outlines) {
    survey.body_shifts.push_back(outline.shift().norm());
  }
  survey.findings =
      assess_consistency(recording, bodies, collector.observations(), survey.camera,
                         std::move(survey.findings), perception.consistency, survey.pairs);
  if (!tracker_options.trust_poses && !known_camera) {
    use_closure(recording, collector.observations(), perception.depth_noise, survey);
  }
  if (has_contradiction(survey.findings)) return contradiction_error(recording, survey.findings);
  for (const ConsistencyFinding& finding : survey.findings) {
    observer.on_warning(finding.to_string());
  }
  if (!has_poses && !known_camera) widen_by_layout(recording.manifest, survey.pairs, survey.camera);
  const bool any_placed = std::any_of(
      survey.camera.frames.begin(), survey.camera.frames.end(),
      [](const FramePlacement& frame) { return frame.status == PlacementStatus::placed; });
  if (!any_placed) return not_placed_error(recording, survey, perception);
  if (std::optional<Error> error = undetermined_camera(survey.camera, recording.folder)) {
    return *error;
  }
  if (std::optional<Error> error =
          moved_poses(survey.camera, recording.groundtruth, tracker_options, recording.folder)) {
    return *error;
  }
  for (const std::string& warning :
       placement_warnings(survey.camera, recording.groundtruth, tracker_options)) {
    observer.on_warning(warning);
  }
  survey.T_base_object_first = first_poses(masker.first_detections(), survey.camera);
  return survey;
}

std::vector<std::pair<std::string, std::size_t>> dropped_frames(const Recording& recording,
                                                                const Survey& survey) {
  std::size_t lost = 0;
  std::size_t not_anchored = 0;
  for (const FramePlacement& frame : survey.camera.frames) {
    lost += frame.status == PlacementStatus::lost ? 1 : 0;
    not_anchored += frame.status == PlacementStatus::not_anchored ? 1 : 0;
  }
  std::vector<std::pair<std::string, std::size_t>> dropped = {
      {"colour without depth near in time", recording.unpaired_color},
      {"depth without colour near in time", recording.unpaired_depth},
      {"did not decode", survey.undecoded},
      {"camera lost", lost},
      {"no link to a base tag", not_anchored}};
  std::erase_if(dropped, [](const auto& reason) { return reason.second == 0; });
  return dropped;
}

}  // namespace pcavr
