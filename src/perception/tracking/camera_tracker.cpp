// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/tracking/camera_tracker.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"

#include "camera_front_end.hpp"
#include "camera_solver.hpp"

namespace pcavr {
namespace {

/// Why no frame was placed; empty if one was.
std::string find_failure_reason(const CameraTrack& track, bool has_base_tags) {
  if (track.frames.empty()) return "no frames";
  const bool is_any_placed = std::any_of(
      track.frames.begin(), track.frames.end(),
      [](const FramePlacement& frame) { return frame.status == PlacementStatus::placed; });
  if (is_any_placed) return {};
  const bool is_any_tracked = std::any_of(
      track.frames.begin(), track.frames.end(),
      [](const FramePlacement& frame) { return frame.status == PlacementStatus::not_anchored; });
  if (!is_any_tracked) return "no frame matches another one, and no base tag was detected";
  const bool is_any_uncertain =
      std::any_of(track.frames.begin(), track.frames.end(),
                  [](const FramePlacement& frame) { return frame.position_std > 0.0; });
  if (is_any_uncertain) {
    return "the camera's poses are less certain than half a metre or 20 degrees (std)";
  }
  return has_base_tags ? "no base tag was detected, and no frame has a given camera pose"
                       : "the recording defines no base tags and has no given camera poses";
}

}  // namespace

struct CameraTracker::State {
  State(const Manifest& manifest, Trajectory poses, const CameraTrackerOptions& chosen)
      : options(chosen),
        base_tags(base_placements(manifest)),
        groundtruth(std::move(poses)),
        camera(*manifest.camera) {}

  CameraTrackerOptions options;
  std::vector<TagPlacement> base_tags;
  Trajectory groundtruth;
  CameraModel camera;  ///< of the colour images
  /// Set at the first frame. Works at the resolution of the depth images: it measures with depth,
  /// and finer colour would only cost time and memory.
  std::optional<tracking::CameraFrontEnd> front_end;
  std::vector<FramePlacement> trusted;  ///< if `trust_poses`
  bool is_solved = false;

  void detect_base(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
                   tracking::FrameRecord& record) const;
  [[nodiscard]] CameraTrack trusted_track() const;
};

void CameraTracker::State::detect_base(const RgbdFrame& frame,
                                       const std::vector<TagDetection>& detections,
                                       tracking::FrameRecord& record) const {
  for (const TagDetection& detection : detections) {
    const bool is_base =
        std::any_of(base_tags.begin(), base_tags.end(),
                    [&](const TagPlacement& tag) { return tag.id == detection.id; });
    if (is_base) record.base_tags.push_back(detection);
  }
  if (record.base_tags.empty()) return;
  BodyPoseHints hints;
  hints.depth = &frame.depth;
  hints.depth_noise = options.depth_noise;
  record.base_from_tags =
      solve_body_pose(base_tags, record.base_tags, camera, hints, options.body_pose);
}

CameraTrack CameraTracker::State::trusted_track() const {
  CameraTrack track;
  track.frames = trusted;
  return track;
}

CameraTracker::CameraTracker(const Manifest& manifest, Trajectory groundtruth,
                             const CameraTrackerOptions& options) {
  PCAVR_REQUIRE(manifest.camera.has_value());
  PCAVR_REQUIRE(options.body_pose.corner_std > 0.0, options.body_pose.corner_std);
  state_ = std::make_unique<State>(manifest, std::move(groundtruth), options);
}

CameraTracker::~CameraTracker() = default;

void CameraTracker::add(const RgbdFrame& frame, const std::vector<TagDetection>& detections,
                        const MaskImage& is_dynamic, Parallelism parallelism) {
  PCAVR_REQUIRE(!state_->is_solved);
  const CameraModel& camera = state_->camera;
  PCAVR_REQUIRE(frame.color.width() == camera.width && frame.color.height() == camera.height);
  const CameraModel depth_camera = on_grid(camera, frame.depth.width(), frame.depth.height());
  if (state_->options.trust_poses) {
    FramePlacement placement;
    placement.frame = frame.index;
    placement.stamp = frame.depth_stamp;
    if (const auto given = state_->groundtruth.at(frame.depth_stamp)) {
      placement.status = PlacementStatus::placed;
      placement.T_base_camera = *given;
    } else {
      placement.status = PlacementStatus::not_anchored;
    }
    state_->trusted.push_back(placement);
    return;
  }
  std::optional<tracking::CameraFrontEnd>& front_end = state_->front_end;
  if (!front_end) front_end.emplace(depth_camera, state_->groundtruth, state_->options);
  PCAVR_REQUIRE(front_end->sensor().camera.width == depth_camera.width);
  tracking::FrameRecord& record = front_end->add(frame, is_dynamic, parallelism);
  state_->detect_base(frame, detections, record);
}

void CameraTracker::ignore_tags(const std::set<MarkerId>& ids) {
  PCAVR_REQUIRE(!state_->is_solved);
  if (!state_->front_end) return;
  for (tracking::FrameRecord& record : state_->front_end->records()) {
    const std::size_t removed = std::erase_if(
        record.base_tags, [&](const TagDetection& tag) { return ids.contains(tag.id); });
    if (removed == 0) continue;
    // Its depth is no longer there; the graph uses the corners alone, and this pose to begin with.
    record.base_from_tags = solve_body_pose(state_->base_tags, record.base_tags, state_->camera, {},
                                            state_->options.body_pose);
  }
}

CameraTrack CameraTracker::solve(const Observer& observer) {
  PCAVR_REQUIRE(!state_->is_solved);
  state_->is_solved = true;
  CameraTrack track;
  if (state_->options.trust_poses) {
    track = state_->trusted_track();
  } else if (state_->front_end) {
    track = tracking::solve_track({&state_->camera, &state_->front_end->keyframes(),
                                   &state_->front_end->records(), &state_->base_tags,
                                   &state_->groundtruth, state_->options});
    track.tracking_rms = state_->front_end->tracking_rms();
  }
  track.failure_reason = find_failure_reason(track, !state_->base_tags.empty());
  observer.on_progress("camera", track.frames.size(), track.frames.size());
  return track;
}

}  // namespace pcavr
