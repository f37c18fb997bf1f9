// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/depth_filter.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "reconstruction/kernels.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kGrainRows = 32;
// Steeper than this the reading is more guess than measurement [Nguyen et al. 2012: the noise
// grows without bound from 70 to 80 deg].
constexpr double kSteepest = 80.0 * std::numbers::pi / 180.0;

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
  /// The row's table; the rest is the caller's.
  [[nodiscard]] FilterRow filter_row() const {
    FilterRow row{};
    row.nearest = nearest_;
    row.steps_per_metre = steps_per_metre_;
    row.max_steps = steps_.data();
    return row;
  }

 private:
  static constexpr int kSteps = 1024;
  float nearest_;
  float farthest_;
  float steps_per_metre_;
  std::vector<float> steps_;
};

/// Readings in range, with a border of one empty pixel, and at each row's end as many as vectors
/// may reach.
DepthImage padded_readings(const DepthImage& depth, const LargestSteps& steps) {
  DepthImage padded(depth.width() + 2 + kMaxLanes, depth.height() + 2);
  for (int v = 0; v < depth.height(); ++v) {
    const std::span<const float> from = depth.row(v);
    const std::span<float> to = padded.row(v + 1);
    for (std::size_t u = 0; u < from.size(); ++u) {
      to[u + 1] = steps.is_in_range(from[u]) ? from[u] : 0.0F;
    }
  }
  return padded;
}

}  // namespace

DepthImage filter_depth(const DepthImage& depth, const CameraModel& camera, const DepthNoise& noise,
                        Parallelism parallelism) {
  const LargestSteps steps(camera, noise);
  const DepthImage padded = padded_readings(depth, steps);
  DepthImage filtered(depth.width(), depth.height());
  parallel_for(parallelism, static_cast<std::size_t>(depth.height()), kGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 FilterRow row = steps.filter_row();
                 row.stride = padded.width();
                 row.width = depth.width();
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   row.centre = padded.row(v + 1).data() + 1;
                   kernels().filter_row(row, filtered.row(v).data());
                 }
               });
  return filtered;
}

}  // namespace pcavr
