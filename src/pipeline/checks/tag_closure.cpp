// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tag_closure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/doubted.hpp"
#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// Depth cameras are off by this share of the distance, the same in all frames [one std].
constexpr double kDepthShare = 0.005;
/// A tag is glued on and measured to a millimetre [m, one std].
constexpr double kTagCentreStd = 1e-3;
/// Offset from which on nothing of the scene is where it is drawn: as for the stds of cameras, and
/// as the share of the distance that a factor of 1.5 makes.
constexpr double kMaxTagOffset = 0.25;  // [m]
constexpr double kMaxTagShare = 1.0 / 3.0;

std::map<std::size_t, const FramePlacement*> certain_frames(const CameraTrack& track) {
  std::map<std::size_t, const FramePlacement*> placed;
  for (const FramePlacement& frame : track.frames) {
    const bool is_known = std::isfinite(frame.position_std) && std::isfinite(frame.rotation_std);
    if (frame.status == PlacementStatus::placed && is_known) placed[frame.frame] = &frame;
  }
  return placed;
}

/// Whether a finding's factor is by how much the camera displaces what it sees: focal lengths,
/// principal point and distortion.
bool is_about_the_lens(const ConsistencyFinding& finding) {
  return finding.place.starts_with("camera.") && finding.place != "camera.depth_scale";
}

}  // namespace

bool TagClosure::is_significant() const { return offset > kSignificantStds * expected; }

double TagClosure::doubted() const { return pcavr::doubted(offset, expected); }

std::optional<TagClosure> close_tags(const Manifest& manifest,
                                     const std::vector<TagMeasurement>& measurements,
                                     const CameraTrack& track, const DepthNoise& noise,
                                     std::size_t min_frames) {
  const std::map<std::size_t, const FramePlacement*> placed = certain_frames(track);
  std::vector<double> offsets, distances, expected;
  std::set<std::size_t> frames;
  for (const TagMeasurement& tag : measurements) {
    const MarkerEntry& marker = manifest.markers[tag.marker];
    const auto frame = placed.find(tag.frame);
    if (marker.role != MarkerRole::base || frame == placed.end()) continue;
    const FramePlacement& placement = *frame->second;
    const Eigen::Vector3d centre_camera = tag.centre_camera();
    const double distance = centre_camera.norm();
    offsets.push_back(
        (placement.T_base_camera * centre_camera - marker.T_parent_marker.translation()).norm());
    distances.push_back(distance);
    expected.push_back(std::hypot(
        std::hypot(placement.position_std, placement.rotation_std * distance),
        std::hypot(noise.depth_std(centre_camera.z()), kDepthShare * distance, kTagCentreStd)));
    frames.insert(tag.frame);
  }
  if (frames.empty() || frames.size() < min_frames) return std::nullopt;
  return TagClosure{.offset = median(std::move(offsets)),
                    .distance = median(std::move(distances)),
                    .expected = median(std::move(expected)),
                    .frames = frames.size()};
}

CameraDoubt doubt_of(const TagClosure& closure, const std::vector<ConsistencyFinding>& findings) {
  double offset = closure.doubted();
  for (const ConsistencyFinding& finding : findings) {
    if (!is_about_the_lens(finding)) continue;
    offset = std::hypot(offset, (finding.factor - 1.0) * closure.distance);
  }
  return {offset, offset / closure.distance};
}

void widen_by(const CameraDoubt& doubt, CameraTrack& track) {
  for (FramePlacement& frame : track.frames) {
    if (frame.status != PlacementStatus::placed) continue;
    frame.position_std = std::hypot(frame.position_std, doubt.position);
    frame.rotation_std = std::hypot(frame.rotation_std, doubt.rotation);
  }
}

ConsistencyFinding finding_of(const TagClosure& closure) {
  const bool is_meaningless =
      closure.offset > std::min(kMaxTagOffset, kMaxTagShare * closure.distance);
  return {.severity = is_meaningless ? FindingSeverity::contradiction : FindingSeverity::warning,
          .file = "recording.yaml",
          .place = "camera, markers",
          .message = fmt::format(
              "images and depth put the base tags {:.0f} mm from their stated poses, at {:.1f} m "
              "(median of {} frames, {:.0f} mm is usual): images, depth, lens and tags contradict "
              "each other, and the camera's stds contain it",
              1e3 * closure.offset, closure.distance, closure.frames, 1e3 * closure.expected),
          .hint =
              "check that colour and depth images of one time have one stamp, the camera's "
              "parameters, and the tags' sizes and poses",
          .frames = closure.frames};
}

}  // namespace pcavr
