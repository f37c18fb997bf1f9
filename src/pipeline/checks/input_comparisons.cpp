// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "input_comparisons.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

void compare_sizes(const Recording& recording, const InspectedFrames& seen, std::size_t min_frames,
                   const ConsistencyOptions& options, std::vector<InputComparison>& comparisons) {
  const Manifest& manifest = recording.manifest;
  std::vector<std::string> inputs{"camera.depth_scale"};
  double worst = 0.0;
  for (const ScaleRatio& ratio :
       tag_ratios(manifest, seen.observations.tags, min_frames, options)) {
    if (ratio.kind != ScaleRatio::Kind::tag_size) continue;
    inputs.push_back(key_of_marker(ratio.first) + ".size");
    const double off = ratio.by_depth / ratio.stated - 1.0;
    if (std::abs(off) > std::abs(worst)) worst = off;
  }
  const char* what = "tag sizes and camera.depth_scale";
  if (inputs.size() > 1) {
    std::string figure = fmt::format("sizes of {} tags by depth: at most {:+.1f} % off",
                                     inputs.size() - 1, 100.0 * worst);
    comparisons.push_back(comparison_of(what, std::move(figure), std::move(inputs)));
  } else {
    comparisons.push_back(failed_comparison(
        what, recording.has_depth ? "no tag with depth inside it is in view" : "no depth images"));
  }
}

void compare_layout(const Manifest& manifest, const InspectedFrames& seen,
                    std::vector<InputComparison>& comparisons) {
  bool has_base_pair = false;
  for (const TagPairCheck& pair : seen.pairs) {
    const MarkerEntry& first = manifest.markers[pair.first];
    const bool is_base = first.role == MarkerRole::base;
    has_base_pair = has_base_pair || is_base;
    comparisons.push_back(comparison_of(
        std::string("poses of tags of ") + (is_base ? "base" : first.object),
        fmt::format(
            "{} and {}: {:.4f} +- {:.4f} m apart by {} images, {:.4f} m as stated; {:.1f} mm "
            "and {} off",
            first.id.to_string(), manifest.markers[pair.second].id.to_string(), pair.distance(),
            pair.distance_std, pair.frames, pair.stated_distance(), 1e3 * pair.offset,
            degrees(pair.rotation)),
        {key_of_marker(pair.first) + ".pose", key_of_marker(pair.second) + ".pose"}));
  }
  if (!has_base_pair) {
    comparisons.push_back(failed_comparison(
        "poses of the base tags", "no two base tags are in view together in enough frames"));
  }
}

void compare_camera(const Recording& recording, const InspectedFrames& seen, std::size_t min_frames,
                    std::vector<InputComparison>& comparisons) {
  const std::size_t tags = seen.observations.tags.size();
  if (tags >= min_frames && tags > 0) {
    comparisons.push_back(comparison_of("camera.fx, camera.fy",
                                        fmt::format("shapes of {} tags by depth are squares", tags),
                                        {"camera.f"}));
  } else {
    comparisons.push_back(failed_comparison(
        "camera.fx, camera.fy",
        recording.has_depth ? "no tag with depth inside it is in view" : "no depth images"));
  }
  if (const auto unchecked = unchecked_camera(recording.manifest)) {
    comparisons.push_back(failed_comparison("camera.cx, camera.cy, camera.distortion", *unchecked));
  }
}

void compare_given_poses(const Recording& recording, const InspectedFrames& seen,
                         const CameraTrack& track, std::vector<InputComparison>& comparisons) {
  const char* what = "groundtruth.txt";
  if (recording.groundtruth.empty()) {
    comparisons.push_back(failed_comparison(what, "there is none"));
    return;
  }
  const auto aligned =
      std::count_if(track.frames.begin(), track.frames.end(),
                    [](const FramePlacement& frame) { return frame.segment >= 0; });
  if (aligned > 1) {
    comparisons.push_back(comparison_of(
        what, fmt::format("camera's motion by tracking {} frames, where it moves enough", aligned),
        {what}));
  } else {
    comparisons.push_back(failed_comparison(what, "no two views could be aligned to each other"));
  }
  const bool has_base = std::any_of(
      seen.observations.tags.begin(), seen.observations.tags.end(), [&](const auto& tag) {
        return recording.manifest.markers[tag.marker].role == MarkerRole::base;
      });
  if (!has_base) {
    comparisons.push_back(
        failed_comparison("groundtruth.txt against base", "no base tag with depth is in view"));
  }
}

void compare_bodies(const Recording& recording, const InspectedFrames& seen,
                    std::vector<InputComparison>& comparisons) {
  std::size_t body = 0;
  for (const ObjectEntry& object : recording.manifest.objects) {
    if (!object.is_movable || object.mesh.empty()) continue;
    const OutlineFit& fit = seen.observations.outlines[body++];
    const std::string what = object.name + "'s mesh";
    if (fit.frames > 0 && fit.outline[kUnscaled] > 0.0) {
      comparisons.push_back(comparison_of(
          what,
          fmt::format("depth in its outline lies on it by {:.0f} % ({} frames)",
                      100.0 * fit.explained[kUnscaled] / fit.outline[kUnscaled], fit.frames),
          {key_of_object(recording.manifest, object.name) + ".mesh"}));
    } else {
      comparisons.push_back(failed_comparison(
          what, recording.has_depth ? "no sampled frame shows its tags" : "no depth images"));
    }
  }
}

/// What is measured of the depth, in metres: a wrong depth_scale is seen in it.
void compare_depth(const Recording& recording, const DepthSummary& depth,
                   std::vector<InputComparison>& comparisons) {
  const char* what = "depth";
  if (!recording.has_depth || depth.medians.empty()) {
    comparisons.push_back(failed_comparison(
        what, recording.has_depth ? "no sampled frame has a reading" : "no depth images"));
    return;
  }
  const auto [nearest, farthest] = std::minmax_element(depth.medians.begin(), depth.medians.end());
  const auto share = [](std::size_t part, std::size_t all) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(all);
  };
  comparisons.push_back(comparison_of(
      what,
      fmt::format("{:.0f} % of the pixels are measured, {:.0f} % of these in the sensor's range; "
                  "median of a frame {:.3f} to {:.3f} m ({} sampled frames)",
                  share(depth.measured, depth.pixels), share(depth.in_range, depth.measured),
                  *nearest, *farthest, depth.frames),
      {"camera.depth_scale"}));
}

}  // namespace

InputComparison comparison_of(std::string what, std::string figure,
                              std::vector<std::string> inputs) {
  return {.what = std::move(what), .figure = std::move(figure), .inputs = std::move(inputs)};
}

InputComparison failed_comparison(std::string what, std::string reason) {
  return {.what = std::move(what), .reason = std::move(reason)};
}

std::vector<InputComparison> compare_images(const Recording& recording, const InspectedFrames& seen,
                                            const CameraTrack& track,
                                            const ConsistencyOptions& options) {
  const std::size_t min_frames = std::min(kMinFindingFrames, recording.frames.size());
  std::vector<InputComparison> comparisons;
  comparisons.push_back(comparison_of("tags in view", tags_text(recording.manifest, seen.tags)));
  compare_depth(recording, seen.observations.depth, comparisons);
  compare_sizes(recording, seen, min_frames, options, comparisons);
  compare_layout(recording.manifest, seen, comparisons);
  compare_camera(recording, seen, min_frames, comparisons);
  compare_given_poses(recording, seen, track, comparisons);
  compare_bodies(recording, seen, comparisons);
  return comparisons;
}

}  // namespace pcavr
