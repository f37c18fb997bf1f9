// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/depth_filter.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "perception/reconstruction/kernels.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kFilterGrainRows = 32;  // amortises the scheduling of a task
// Beyond this incidence depth is unreliable [Nguyen et al. 2012: the noise diverges from 70 to 80
// deg].
constexpr double kMaxIncidence = 80.0 * std::numbers::pi / 180.0;

/// Maximum depth difference between neighbouring pixels of one surface [m], tabulated over depth.
class MaxDepthSteps {
 public:
  MaxDepthSteps(const CameraModel& camera, const DepthNoise& noise)
      : min_depth_(static_cast<float>(noise.min_depth)),
        max_depth_(static_cast<float>(noise.max_depth)),
        steps_per_metre_(static_cast<float>((kSteps - 1) / (noise.max_depth - noise.min_depth))) {
    // One extra entry, against rounding.
    for (int i = 0; i <= kSteps; ++i) {
      const double z = noise.min_depth + (noise.max_depth - noise.min_depth) * i / (kSteps - 1);
      const double slope = z / camera.fx * std::tan(kMaxIncidence);
      steps_.push_back(static_cast<float>(3.0 * std::numbers::sqrt2 * noise.depth_std(z) + slope));
    }
  }
  /// The result is false for NaN, too.
  [[nodiscard]] bool is_in_range(float z) const { return z >= min_depth_ && z <= max_depth_; }
  /// A row with the depth range and the table set; the caller sets the rest.
  [[nodiscard]] FilterRow filter_row() const {
    FilterRow row{};
    row.min_depth = min_depth_;
    row.steps_per_metre = steps_per_metre_;
    row.max_steps = steps_.data();
    return row;
  }

 private:
  static constexpr int kSteps = 1024;  // 5 mm over a range of 5 m
  float min_depth_;
  float max_depth_;
  float steps_per_metre_;
  std::vector<float> steps_;
};

/// Depth in range, padded by one empty pixel on each side and by a SIMD vector at each row's end.
DepthImage padded_depth(const DepthImage& depth, const MaxDepthSteps& steps) {
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
  const MaxDepthSteps steps(camera, noise);
  const DepthImage padded = padded_depth(depth, steps);
  DepthImage filtered(depth.width(), depth.height());
  parallel_for(parallelism, static_cast<std::size_t>(depth.height()), kFilterGrainRows,
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
