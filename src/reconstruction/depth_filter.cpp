// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/depth_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

namespace pcavr {
namespace {

constexpr std::size_t kGrainRows = 32;
// Steeper than this the reading is more guess than measurement [Nguyen et al. 2012: the noise
// grows without bound from 70 to 80 deg].
constexpr double kSteepest = 80.0 * std::numbers::pi / 180.0;
// A straight edge leaves five of eight neighbours, a corner three; a gross error has none.
constexpr int kLeastCompanions = 3;
// A jump along an edge disagrees with three neighbours, a lone gross error with one.
constexpr int kMostStrangers = 1;

/// Largest difference in depth between neighbouring pixels of one surface [m], over depth.
class LargestSteps {
 public:
  LargestSteps(const CameraModel& camera, const DepthNoise& noise)
      : nearest_(static_cast<float>(noise.nearest)),
        farthest_(static_cast<float>(noise.farthest)),
        steps_per_metre_(static_cast<float>((kSteps - 1) / (noise.farthest - noise.nearest))) {
    // One more than is asked for, against rounding.
    for (int i = 0; i <= kSteps; ++i) {
      const double z = noise.nearest + (noise.farthest - noise.nearest) * i / (kSteps - 1);
      const double slope = z / camera.fx * std::tan(kSteepest);
      steps_.push_back(static_cast<float>(3.0 * std::numbers::sqrt2 * noise.sigma(z) + slope));
    }
  }
  /// Also false for NaN.
  [[nodiscard]] bool is_in_range(float z) const { return z >= nearest_ && z <= farthest_; }
  [[nodiscard]] float at(float z) const {
    return steps_[static_cast<std::size_t>(std::max(0.0F, (z - nearest_) * steps_per_metre_))];
  }

 private:
  static constexpr int kSteps = 1024;
  float nearest_;
  float farthest_;
  float steps_per_metre_;
  std::vector<float> steps_;
};

/// Readings in range, with a border of one empty pixel.
DepthImage padded_readings(const DepthImage& depth, const LargestSteps& steps) {
  DepthImage padded(depth.width() + 2, depth.height() + 2);
  for (int v = 0; v < depth.height(); ++v) {
    const std::span<const float> from = depth.row(v);
    const std::span<float> to = padded.row(v + 1);
    for (std::size_t u = 0; u < from.size(); ++u) {
      to[u + 1] = steps.is_in_range(from[u]) ? from[u] : 0.0F;
    }
  }
  return padded;
}

/// Keeps the pixels of one row that enough neighbours agree with. `centre` points at the first
/// pixel of the padded row, `stride` is to the next one.
void filter_row(const float* centre, std::ptrdiff_t stride, const std::vector<float>& largest_step,
                std::span<float> filtered) {
  const float* above = centre - stride;
  const float* below = centre + stride;
  const float* steps = largest_step.data();
  float* to = filtered.data();
  for (std::size_t u = 0, width = filtered.size(); u < width; ++u) {
    const float z = centre[u];
    const float step = steps[u];
    int companions = 0;
    int strangers = 0;
    // Written for the vectoriser: no branches, the eight neighbours spelt out.
    const auto count = [&](float other) {
      const int is_there = other > 0.0F ? 1 : 0;
      const int is_near = std::abs(other - z) <= step ? 1 : 0;
      companions += is_there & is_near;
      strangers += is_there & (1 - is_near);
    };
    count(above[static_cast<std::ptrdiff_t>(u) - 1]);
    count(above[u]);
    count(above[u + 1]);
    count(centre[static_cast<std::ptrdiff_t>(u) - 1]);
    count(centre[u + 1]);
    count(below[static_cast<std::ptrdiff_t>(u) - 1]);
    count(below[u]);
    count(below[u + 1]);
    to[u] = ((companions >= kLeastCompanions) & (strangers <= kMostStrangers)) != 0 ? z : 0.0F;
  }
}

}  // namespace

DepthImage filter_depth(const DepthImage& depth, const CameraModel& camera, const DepthNoise& noise,
                        Parallelism parallelism) {
  const LargestSteps steps(camera, noise);
  const DepthImage padded = padded_readings(depth, steps);
  DepthImage filtered(depth.width(), depth.height());
  parallel_for(parallelism, static_cast<std::size_t>(depth.height()), kGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 std::vector<float> largest_step(static_cast<std::size_t>(depth.width()));
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   const float* centre = padded.row(v + 1).data() + 1;
                   for (std::size_t u = 0; u < largest_step.size(); ++u) {
                     largest_step[u] = steps.at(centre[u]);
                   }
                   filter_row(centre, padded.width(), largest_step, filtered.row(v));
                 }
               });
  return filtered;
}

}  // namespace pcavr
