// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "placement_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// Stds beyond which nothing of a scene is where it is drawn: a room's walls and the reach of an
/// arm are off by a quarter. Sound recordings are known to some centimetres at worst.
constexpr double kMaxPositionStd = 0.25;  // [m]
constexpr double kMaxRotationStd = 0.35;  // [rad], 20 degrees

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

/// Given poses that are further from the track than three standard deviations of both.
std::string contradicted_poses(const CameraTrack& track, const Trajectory& given,
                               const CameraTrackerOptions& options) {
  std::vector<std::size_t> frames;
  double worst = 0.0;
  for (const FramePlacement& frame : track.frames) {
    const auto pose = given.at(frame.stamp);
    if (frame.status != PlacementStatus::placed || !pose) continue;
    const double given_std = std::numbers::sqrt3 * options.groundtruth_position_std;
    const double offset = translation_distance(*pose, frame.T_base_camera);
    if (offset < 3.0 * std::hypot(given_std, frame.position_std)) continue;
    frames.push_back(frame.frame);
    worst = std::max(worst, offset);
  }
  if (frames.empty()) return {};
  return fmt::format(
      "groundtruth.txt: its poses of {} are up to {:.0f} mm off what the images show with the "
      "others, and are outweighed; --trust-poses takes them as they are",
      frames_text(frames), 1e3 * worst);
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
