// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/consistency.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "assess_consistency.hpp"
#include "contact_comparisons.hpp"
#include "input_comparisons.hpp"
#include "pipeline/build/survey.hpp"
#include "pipeline/robot/recorded_arm.hpp"
#include "tag_copies.hpp"
#include "tracked_start.hpp"

namespace pcavr {
namespace {

bool is_contradiction(const ConsistencyFinding& finding) {
  return finding.severity == FindingSeverity::contradiction;
}

void append(std::vector<ConsistencyFinding>& findings, std::vector<ConsistencyFinding> more) {
  std::move(more.begin(), more.end(), std::back_inserter(findings));
}

/// A finding from the depth in the outline replaces a warning about tags off the mesh: it is more
/// certain about the mesh's scale.
void add_outline_finding(std::vector<ConsistencyFinding>& findings,
                         const ConsistencyFinding& outline) {
  std::erase_if(findings, [&](const ConsistencyFinding& finding) {
    return finding.place == outline.place && !is_contradiction(finding);
  });
  findings.push_back(outline);
}

/// Whether a finding is about what was compared.
bool is_contradicted(const InputComparison& comparison,
                     const std::vector<ConsistencyFinding>& findings) {
  return comparison.is_compared() &&
         std::any_of(findings.begin(), findings.end(), [&](const ConsistencyFinding& finding) {
           return std::any_of(
               comparison.inputs.begin(), comparison.inputs.end(),
               [&](const std::string& input) { return finding.input().find(input) != input.npos; });
         });
}

/// Frames that inspect samples: enough for a median, and quick compared with decoding all.
constexpr std::size_t kInspectedFrames = 16;
/// Consecutive frames for the camera's motion: some seconds, close enough in time for alignment
/// (ICP).
constexpr std::size_t kTrackedFrames = 24;
constexpr double kTrackedInterval = 0.12;  // [s]

/// `count` frames over the whole recording.
std::vector<std::size_t> spread_frames(std::size_t frames, std::size_t count) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < std::min(frames, count); ++i) {
    chosen.push_back(i * frames / std::min(frames, count));
  }
  return chosen;
}

/// Frames from a quarter of the recording on, at least kTrackedInterval apart.
std::vector<std::size_t> consecutive_frames(const Recording& recording) {
  std::vector<std::size_t> chosen;
  const std::size_t count = recording.frames.size();
  for (std::size_t i = count / 4; i < count && chosen.size() < kTrackedFrames; ++i) {
    const Stamp stamp = recording.frames[i].depth_stamp;
    if (chosen.empty() ||
        to_seconds(stamp - recording.frames[chosen.back()].depth_stamp) >= kTrackedInterval) {
      chosen.push_back(i);
    }
  }
  return chosen;
}

Expected<CameraTrack> track_some(const Recording& recording, const PerceptionOptions& options) {
  CameraTracker tracker(recording.manifest, {}, camera_options(options));
  for (const std::size_t index : consecutive_frames(recording)) {
    const Expected<RgbdFrame> frame = decode_frame(recording, index);
    if (!frame) return frame.error();
    tracker.add(*frame, {}, {}, Parallelism::max());
  }
  return tracker.solve();
}

/// The movable objects that have a CAD body; a missing one is reported by build.
Expected<std::vector<DeclaredBody>> bodies_with_mesh(const Recording& recording,
                                                     const CadOptions& options) {
  std::vector<DeclaredBody> bodies;
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (!entry.is_movable || entry.mesh.empty()) continue;
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, options, entry.mesh_unit);
    if (!model) return model.error();
    bodies.push_back({entry, *std::move(model), object_placements(recording.manifest, entry.name)});
  }
  return bodies;
}

/// Measures tags and body outlines in a subset of the frames.
Expected<InspectedFrames> observe_some(const Recording& recording,
                                       const std::vector<DeclaredBody>& bodies,
                                       const std::vector<SurfaceQuery>& surfaces,
                                       const PerceptionOptions& options, FamilySearch families) {
  TagDetectorOptions detector_options = options.tag_detector;
  detector_options.full_search_interval = 1;  // the frames are too far apart for regions
  Expected<std::optional<TagDetector>> detector = make_tag_detector(recording, detector_options);
  if (!detector) return detector.error();
  const std::vector<std::size_t> chosen = spread_frames(recording.frames.size(), kInspectedFrames);
  ConsistencyCollector collector(recording.manifest, options.depth_noise, surfaces, chosen.size());
  TagCopies copies;
  TagsInView tags{.frames = chosen.size()};
  std::vector<std::vector<TagDetection>> seen;
  for (const std::size_t index : chosen) {
    const Expected<RgbdFrame> frame = decode_frame(recording, index);
    if (!frame) return frame.error();
    std::vector<TagDetection> detections;
    if (*detector) {
      detections = (*detector)->detect(to_gray(frame->color));
      copies.add(detections, (*detector)->seen_twice());
      for (const TagDetection& tag : detections) ++tags.seen[tag.id];
      for (const MarkerId& id : (*detector)->seen_twice()) ++tags.seen[id];
    }
    std::vector<std::optional<Pose>> T_camera_body;
    for (const DeclaredBody& body : bodies) {
      const BodyPose pose = solve_body_pose(
          body.tags, detections, *recording.manifest.camera,
          {.depth = &frame->depth, .depth_noise = options.depth_noise}, options.body_pose);
      T_camera_body.push_back(pose.status == BodyPoseStatus::solved
                                  ? std::optional<Pose>(pose.pose.T_camera_body)
                                  : std::nullopt);
    }
    collector.add(*frame, detections, T_camera_body);
    seen.push_back(std::move(detections));
  }
  collector.ignore_tags(copies.ids(), bodies_with_tags(bodies, copies.ids()));
  for (std::vector<TagDetection>& detections : seen) remove_tags(copies.ids(), detections);
  const Expected<void> searched =
      search_other_families(recording, chosen, options.tag_detector, families, tags);
  if (!searched) return searched.error();
  return InspectedFrames{
      collector.observations(),
      compare_tag_pairs(recording.manifest, seen, std::min(kMinFindingFrames, chosen.size()),
                        options.body_pose),
      copies.findings(recording.manifest), std::move(tags)};
}

}  // namespace

bool has_contradiction(const std::vector<ConsistencyFinding>& findings) {
  return std::any_of(findings.begin(), findings.end(), is_contradiction);
}

Error contradiction_error(const Recording& recording,
                          const std::vector<ConsistencyFinding>& findings) {
  const auto first = std::find_if(findings.begin(), findings.end(), is_contradiction);
  PCAVR_REQUIRE(first != findings.end());
  const auto others = std::count_if(std::next(first), findings.end(), is_contradiction);
  Error error{.message = first->message,
              .file = (recording.folder / first->file).string(),
              .place = first->place,
              .hint = first->hint};
  if (others > 0) {
    error.hint += " (" + std::to_string(others) +
                  (others == 1 ? " contradiction" : " contradictions") +
                  " more: run pcavr inspect)";
  }
  return error;
}

std::vector<ConsistencyFinding> check_bodies(const Recording& recording,
                                             const std::vector<DeclaredBody>& bodies,
                                             const std::vector<SurfaceQuery>& surfaces,
                                             const ConsistencyOptions& options) {
  std::vector<ConsistencyFinding> findings;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    append(findings,
           check_body(recording.manifest, bodies[i].entry, bodies[i].model, surfaces[i], options));
  }
  return findings;
}

std::vector<ConsistencyFinding> assess_consistency(const Recording& recording,
                                                   const std::vector<DeclaredBody>& bodies,
                                                   const ConsistencyObservations& seen,
                                                   const CameraTrack& track,
                                                   std::vector<ConsistencyFinding> findings,
                                                   const ConsistencyOptions& options,
                                                   const std::vector<TagPairCheck>& pairs) {
  const Manifest& manifest = recording.manifest;
  const std::size_t min_frames = std::min(kMinFindingFrames, recording.frames.size());
  const auto focal_lengths = check_focal_lengths(manifest, seen.tags, min_frames, options);
  if (focal_lengths) {
    findings.push_back(*focal_lengths);
    // The following checks use these focal lengths.
    if (is_contradiction(*focal_lengths)) return sorted(std::move(findings));
  }
  std::vector<ScaleRatio> ratios = tag_ratios(manifest, seen.tags, min_frames, options);
  const auto motion = check_camera_motion(track, recording.groundtruth, options);
  if (motion) findings.push_back(*motion);
  // The unit of poses in another convention can't be checked.
  const auto distance = motion_ratio(track, recording.groundtruth, options);
  if (distance && !(motion && is_contradiction(*motion))) ratios.push_back(*distance);
  const std::vector<ConsistencyFinding> scales = check_scales(manifest, ratios, options);
  append(findings, scales);
  if (has_contradiction(scales)) return sorted(std::move(findings));
  if (scales.empty() && !focal_lengths) {
    if (const auto lens = check_principal_point(manifest, seen.tags, min_frames, options)) {
      findings.push_back(*lens);
      if (is_contradiction(*lens)) return sorted(std::move(findings));
    }
  }
  append(findings, check_tag_layout(manifest, pairs, options));

  std::vector<Stamp> depth_stamps;
  for (const FrameFiles& frame : recording.frames) depth_stamps.push_back(frame.depth_stamp);
  if (const auto offset = check_camera_offset(manifest, recording.groundtruth, seen.tags,
                                              depth_stamps, min_frames, options)) {
    findings.push_back(*offset);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto outline =
        check_outline(manifest, bodies[i].entry, seen.outlines[i], min_frames, options);
    if (outline) add_outline_finding(findings, *outline);
    const auto place = check_place(manifest, bodies[i].entry, seen.outlines[i], min_frames);
    if (place && !outline) findings.push_back(*place);
  }
  return sorted(std::move(findings));
}

std::vector<ConsistencyFinding> sorted(std::vector<ConsistencyFinding> findings) {
  std::stable_partition(findings.begin(), findings.end(), is_contradiction);
  return findings;
}

Expected<InputReport> inspect_inputs(const Recording& recording, const PerceptionOptions& options,
                                     FamilySearch families) {
  const Expected<std::optional<RecordedArm>> arm = read_recorded_joints(recording);
  if (!arm) return arm.error();
  const Expected<std::vector<DeclaredBody>> bodies = bodies_with_mesh(recording, options.cad);
  if (!bodies) return bodies.error();
  std::vector<SurfaceQuery> surfaces;
  for (const DeclaredBody& body : *bodies) surfaces.emplace_back(body.model.mesh_object);
  InputReport report;
  report.findings = check_bodies(recording, *bodies, surfaces, options.consistency);
  const Expected<std::vector<ConsistencyFinding>> tracks = check_own_tracks(recording, *bodies);
  if (!tracks) return tracks.error();
  append(report.findings, *tracks);
  if (recording.manifest.camera && !recording.frames.empty()) {
    const Expected<InspectedFrames> seen =
        observe_some(recording, *bodies, surfaces, options, families);
    if (!seen) return seen.error();
    append(report.findings, seen->copied_tags);
    append(report.findings, check_tags_in_view(recording, seen->tags));
    report.tags = searched_tags(recording.manifest, seen->tags);
    CameraTrack track;
    if (!recording.groundtruth.empty()) {
      Expected<CameraTrack> tracked = track_some(recording, options);
      if (!tracked) return tracked.error();
      track = *std::move(tracked);
    }
    report.findings =
        assess_consistency(recording, *bodies, seen->observations, track,
                           std::move(report.findings), options.consistency, seen->pairs);
    report.comparisons = compare_images(recording, *seen, track, options.consistency);
  } else {
    report.comparisons.push_back({.what = "tags, camera and depth", .reason = "no images"});
  }
  std::vector<InputComparison> contacts = compare_contacts(recording, options, report.findings);
  std::move(contacts.begin(), contacts.end(), std::back_inserter(report.comparisons));
  report.findings = sorted(std::move(report.findings));
  std::erase_if(report.comparisons,
                [&](const InputComparison& one) { return is_contradicted(one, report.findings); });
  return report;
}

}  // namespace pcavr
