// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "survey.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

#include "pipeline/checks/assess_consistency.hpp"
#include "pipeline/checks/tag_closure.hpp"
#include "pipeline/checks/tag_copies.hpp"
#include "placement_warnings.hpp"
#include "prefetcher.hpp"

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

/// A body's first detection.
struct FirstDetection {
  std::size_t frame = 0;
  Pose T_camera_body;
};

/// Masks the pixels of movable bodies whose poses follow from a frame's tags, and stores each
/// body's first detection. Without masks, later poses are solved only in frames that need them.
class BodyMasker {
 public:
  BodyMasker(const std::vector<DeclaredBody>& bodies, const CameraModel& camera,
             const PerceptionOptions& options, bool with_masks)
      : bodies_(bodies),
        camera_(camera),
        options_(options),
        with_masks_(with_masks),
        last_poses_(bodies.size()),
        first_detections_(bodies.size()) {
    for (const DeclaredBody& body : bodies) surfaces_.emplace_back(body.model.mesh_object);
  }

  [[nodiscard]] const std::vector<std::optional<FirstDetection>>& first_detections() const {
    return first_detections_;
  }

  /// Repeats the first detections of the bodies with these tags by their other tags, in `seen`.
  void ignore_tags(const std::set<MarkerId>& ids,
                   const std::vector<std::vector<TagDetection>>& seen) {
    for (const std::size_t i : bodies_with_tags(bodies_, ids)) {
      first_detections_[i].reset();
      for (std::size_t frame = 0; frame < seen.size() && !first_detections_[i]; ++frame) {
        const BodyPose body =
            solve_body_pose(bodies_[i].tags, seen[frame], camera_, {}, options_.body_pose);
        if (body.status != BodyPoseStatus::solved) continue;
        first_detections_[i] = {frame, body.pose.T_camera_body};
      }
    }
  }

  /// The bodies' poses by the last frame's tags.
  [[nodiscard]] const std::vector<std::optional<Pose>>& last_poses() const { return last_poses_; }
  [[nodiscard]] const std::vector<SurfaceQuery>& surfaces() const { return surfaces_; }

  [[nodiscard]] MaskImage mask(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
                               bool needs_poses) {
    if (bodies_.empty()) return {};
    const CameraModel depth_camera = on_grid(camera_, frame.depth.width(), frame.depth.height());
    MaskImage mask;
    if (with_masks_) mask = MaskImage(depth_camera.width, depth_camera.height);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (!with_masks_ && !needs_poses && first_detections_[i]) {
        last_poses_[i].reset();
        continue;
      }
      const BodyPoseHints hints{.depth = &frame.depth,
                                .depth_noise = options_.depth_noise,
                                .T_camera_body = last_poses_[i]};
      const BodyPose body =
          solve_body_pose(bodies_[i].tags, detections, camera_, hints, options_.body_pose);
      last_poses_[i].reset();
      if (body.status != BodyPoseStatus::solved) continue;
      last_poses_[i] = body.pose.T_camera_body;
      if (!first_detections_[i]) first_detections_[i] = {frame.index, body.pose.T_camera_body};
      if (!with_masks_) continue;
      mask_body(surfaces_[i], body.pose.T_camera_body, depth_camera, frame.depth,
                options_.depth_noise, options_.masks.first_body_margin, mask);
    }
    return mask;
  }

 private:
  const std::vector<DeclaredBody>& bodies_;
  CameraModel camera_;
  const PerceptionOptions& options_;
  bool with_masks_;
  std::vector<SurfaceQuery> surfaces_;
  std::vector<std::optional<Pose>> last_poses_;
  std::vector<std::optional<FirstDetection>> first_detections_;
};

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

std::vector<std::size_t> bodies_with_tags(const std::vector<DeclaredBody>& bodies,
                                          const std::set<MarkerId>& ids) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::vector<TagPlacement>& tags = bodies[i].tags;
    if (std::any_of(tags.begin(), tags.end(),
                    [&](const TagPlacement& tag) { return ids.contains(tag.id); })) {
      found.push_back(i);
    }
  }
  return found;
}

Expected<std::vector<DeclaredBody>> load_movable_bodies(const Recording& recording,
                                                        const CadOptions& options) {
  std::vector<DeclaredBody> bodies;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (!entry.is_movable) continue;
    if (entry.mesh.empty()) {
      return Error{.message = "the movable object has no CAD mesh",
                   .file = (recording.folder / "recording.yaml").string(),
                   .place = "objects: " + entry.name,
                   .hint = "add mesh: with its .obj, .stl, .ply or .glb file"};
    }
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, options, entry.mesh_unit);
    if (!model) return model.error();
    bodies.push_back({entry, std::move(*model), object_placements(recording.manifest, entry.name)});
  }
  return bodies;
}

Expected<std::vector<DeclaredBody>> load_immovable_bodies(const Recording& recording,
                                                          const CadOptions& options) {
  std::vector<DeclaredBody> bodies;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (entry.is_movable || entry.mesh.empty() || !entry.T_base_object) continue;
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, options, entry.mesh_unit);
    if (!model) return model.error();
    bodies.push_back({entry, std::move(*model), {}});
  }
  return bodies;
}

void report_simplified(const CadModel& model, const Observer& observer) {
  if (!model.simplification) return;
  observer.on_warning(fmt::format(
      "{}: CAD mesh of {} triangles simplified to {}, error at most {:.3f} mm; volume and centre "
      "of mass are those of the full mesh",
      model.name, model.simplification->full_triangles, model.mesh_object.triangles.size(),
      1e3 * model.simplification->max_error));
}

std::vector<MarkerEntry> scene_tags(const Manifest& manifest) {
  std::vector<MarkerEntry> tags = manifest.markers;
  std::erase_if(tags, [&](const MarkerEntry& tag) {
    return tag.role == MarkerRole::object &&
           std::any_of(manifest.objects.begin(), manifest.objects.end(),
                       [&](const ObjectEntry& object) {
                         return object.name == tag.object && !object.is_movable;
                       });
  });
  return tags;
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
