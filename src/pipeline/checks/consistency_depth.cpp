// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// Smallest share of the depth in range: what a smaller one leaves are artefacts at edges and
/// reflections.
constexpr double kMinInRange = 0.05;
/// Frames farther apart than this do not overlap [m, rad]: no surface is observed twice.
constexpr double kMaxFrameDistance = 0.5;
constexpr double kMaxTurn = 45.0 * std::numbers::pi / 180.0;

std::string per_cent(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

double part_of(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

}  // namespace

bool is_out_of_range(const DepthSummary& depth) {
  return part_of(depth.in_range, depth.measured) < kMinInRange;
}

EmptySceneCause explain_empty_scene(const DepthSummary& depth, const DepthNoise& noise,
                                    double depth_scale, const CameraSteps& camera,
                                    double min_weight) {
  const double in_range = part_of(depth.in_range, depth.measured);
  const std::string seen = "the median depth is " + measured(median(depth.medians)) + ", and " +
                           per_cent(in_range) + " of the readings lie within " +
                           number(noise.min_depth) + " to " + metres(noise.max_depth);
  const auto frames_used = static_cast<double>(camera.frames_used);
  if (is_out_of_range(depth)) {
    return {seen, "check camera.depth_scale (" + number(depth_scale) +
                      " units per metre), or give the sensor's range with --sensor"};
  }
  if (frames_used < min_weight) {
    return {std::to_string(camera.frames_used) + " of " + std::to_string(depth.frames) +
                " frames could be used, but a surface needs at least " + number(min_weight) +
                " frames",
            "record more frames of the same scene"};
  }
  if (camera.translation > kMaxFrameDistance || camera.rotation > kMaxTurn) {
    return {"the camera poses are scattered: from frame to frame it moves by " +
                measured(camera.translation) + " and " + degrees(camera.rotation) + " (median)",
            "check groundtruth.txt: metres, quaternions as qx qy qz qw, the recording's clock"};
  }
  return {"no two of " + std::to_string(camera.frames_used) + " frames agree on a surface; " + seen,
          "check camera.depth_scale, fx, fy, cx, cy and the camera's poses"};
}

}  // namespace pcavr
