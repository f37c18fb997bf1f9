// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "placement_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/perception/tracking/stated_poses.hpp"

namespace pcavr {
namespace {

/// Stds beyond which nothing of a scene is where it is drawn: a room's walls and the reach of an
/// arm are off by a quarter. Sound recordings are known to some centimetres at worst.
constexpr double kMaxPositionStd = 0.25;  // [m]
constexpr double kMaxRotationStd = 0.35;  // [rad], 20 degrees

/// Stds of given poses and track beyond which a pose is reported, and is an error if its std is
/// stated: one in some 2 million of honest stds.
constexpr double kWarningStds = 3.0;
constexpr double kMaxStatedStds = 5.0;

constexpr std::size_t kMaxRanges = 6;  // more are counted: the sentence stays readable

/// "frames 3 to 8, 12": of increasing indices.
std::string frames_text(const std::vector<std::size_t>& frames) {
  std::string text = frames.size() == 1 ? "frame " : "frames ";
  std::size_t ranges = 0;
  for (std::size_t first = 0; first < frames.size();) {
    std::size_t last = first;
    while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
    if (ranges == kMaxRanges) return text + fmt::format(" and {} more", frames.size() - first);
    if (ranges++ > 0) text += ", ";
    text += std::to_string(frames[first]);
    if (last > first) text += (last > first + 1 ? " to " : ", ") + std::to_string(frames[last]);
    first = last + 1;
  }
  return text;
}

std::vector<std::size_t> frames_that(const CameraTrack& track, PlacementStatus status) {
  std::vector<std::size_t> frames;
  for (const FramePlacement& frame : track.frames) {
    if (frame.status == status) frames.push_back(frame.frame);
  }
  return frames;
}

/// A frame that is not where its given pose has it.
struct MovedPose {
  const FramePlacement* frame = nullptr;
  double offset = 0.0;  ///< [m]
  double angle = 0.0;   ///< [rad]
  double stds = 0.0;    ///< the larger of both, in stds of both poses
};

std::vector<MovedPose> moved_by_more_than(double max_stds, const CameraTrack& track,
                                          const Trajectory& given,
                                          const CameraTrackerOptions& options) {
  std::vector<MovedPose> moved;
  for (const FramePlacement& frame : track.frames) {
    const auto pose = given.at(frame.stamp);
    if (frame.status != PlacementStatus::placed || !pose) continue;
    MovedPose one{&frame, translation_distance(*pose, frame.T_base_camera),
                  rotation_distance(*pose, frame.T_base_camera)};
    const double position_std =
        std::hypot(std::numbers::sqrt3 * options.groundtruth_position_std, frame.position_std);
    const double rotation_std =
        std::hypot(std::numbers::sqrt3 * options.groundtruth_rotation_std, frame.rotation_std);
    one.stds = std::max(one.offset / position_std, one.angle / rotation_std);
    if (one.stds > max_stds) moved.push_back(one);
  }
  return moved;
}

/// Given poses that are further from the track than three standard deviations of both.
std::string contradicted_poses(const CameraTrack& track, const Trajectory& given,
                               const CameraTrackerOptions& options) {
  std::vector<std::size_t> frames;
  double offset = 0.0, angle = 0.0;
  for (const MovedPose& one : moved_by_more_than(kWarningStds, track, given, options)) {
    frames.push_back(one.frame->frame);
    offset = std::max(offset, one.offset);
    angle = std::max(angle, one.angle);
  }
  if (frames.empty()) return {};
  return fmt::format(
      "groundtruth.txt: its poses of {} are up to {:.0f} mm and {:.1f} deg off what the images "
      "show with the others, and are outweighed; --trust-poses takes them as they are",
      frames_text(frames), 1e3 * offset, angle * 180.0 / std::numbers::pi);
}

}  // namespace

std::optional<Error> undetermined_camera(const CameraTrack& track,
                                         const std::filesystem::path& recording) {
  std::vector<double> position, rotation;
  for (const FramePlacement& frame : track.frames) {
    const bool is_known = std::isfinite(frame.position_std) && std::isfinite(frame.rotation_std);
    if (frame.status != PlacementStatus::placed || !is_known) continue;
    position.push_back(frame.position_std);
    rotation.push_back(frame.rotation_std);
  }
  if (position.empty()) return std::nullopt;
  const double position_std = median(std::move(position));
  const double rotation_std = median(std::move(rotation));
  if (position_std <= kMaxPositionStd && rotation_std <= kMaxRotationStd) return std::nullopt;
  return Error{
      .message = fmt::format("the camera's poses are known to +-{:.2f} m, +-{:.0f} deg only",
                             position_std, rotation_std * 180.0 / std::numbers::pi),
      .file = recording.string(),
      .hint = "show base tags in more views, or pass --trust-poses if groundtruth.txt is exact"};
}

std::optional<Error> moved_poses(const CameraTrack& track, const Trajectory& given,
                                 const CameraTrackerOptions& options,
                                 const std::filesystem::path& recording) {
  if (options.trust_poses || !are_pose_stds_stated(options)) return std::nullopt;
  std::vector<MovedPose> moved = moved_by_more_than(kMaxStatedStds, track, given, options);
  if (moved.empty()) return std::nullopt;
  std::ranges::stable_sort(moved, std::greater(), &MovedPose::stds);
  std::string list;
  for (std::size_t i = 0; i < std::min(moved.size(), kMaxRanges); ++i) {
    const MovedPose& one = moved[i];
    list +=
        fmt::format("{}frame {} by {:.0f} mm and {:.1f} deg ({:.0f} stds, {})", i > 0 ? ", " : "",
                    one.frame->frame, 1e3 * one.offset, one.angle * 180.0 / std::numbers::pi,
                    one.stds, one.frame->base_tags > 0 ? "base tags in view" : "other views");
  }
  if (moved.size() > kMaxRanges) list += fmt::format(" and {} more", moved.size() - kMaxRanges);
  return Error{
      .message = fmt::format("its poses of {} frames are contradicted by more than {:.0f} stds: {}",
                             moved.size(), kMaxStatedStds, list),
      .file = (recording / "groundtruth.txt").string(),
      .place = {},
      .hint = "remove them, state a larger --pose-std, or take them as they are: --trust-poses"};
}

std::vector<std::string> placement_warnings(const CameraTrack& track, const Trajectory& given,
                                            const CameraTrackerOptions& options) {
  std::vector<std::string> warnings;
  const auto not_anchored = frames_that(track, PlacementStatus::not_anchored);
  if (!not_anchored.empty()) {
    warnings.push_back(fmt::format(
        "{} {} left out: no view of a base tag is near enough to place {} by; record more views "
        "in between, show a base tag, or give poses in groundtruth.txt",
        frames_text(not_anchored), not_anchored.size() == 1 ? "is" : "are",
        not_anchored.size() == 1 ? "it" : "them"));
  }
  const auto lost = frames_that(track, PlacementStatus::lost);
  if (!lost.empty()) {
    warnings.push_back(
        fmt::format("{} {} left out: too little of the surface is in view, or no other view fits",
                    frames_text(lost), lost.size() == 1 ? "is" : "are"));
  }
  if (track.links_rejected > 0) {
    warnings.push_back(fmt::format(
        "groundtruth.txt: {} alignments between views contradict its poses, and are not used: "
        "places that look alike, or poses that are off",
        track.links_rejected));
  }
  if (!options.trust_poses) {
    std::string contradicted = contradicted_poses(track, given, options);
    if (!contradicted.empty()) warnings.push_back(std::move(contradicted));
  }
  return warnings;
}

}  // namespace pcavr
