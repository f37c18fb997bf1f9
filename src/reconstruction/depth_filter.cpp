// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/depth_filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
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
      : nearest_(static_cast<float>(noise.nearest)), farthest_(static_cast<float>(noise.farthest)) {
    for (int i = 0; i < kSteps; ++i) {
      const double z = noise.nearest + (noise.farthest - noise.nearest) * i / (kSteps - 1);
      const double slope = z / camera.fx * std::tan(kSteepest);
      steps_.push_back(static_cast<float>(3.0 * std::numbers::sqrt2 * noise.sigma(z) + slope));
    }
  }
  /// Also false for NaN.
  [[nodiscard]] bool is_in_range(float z) const { return z >= nearest_ && z <= farthest_; }
  [[nodiscard]] float at(float z) const {
    const float place = (z - nearest_) / (farthest_ - nearest_) * (kSteps - 1);
    return steps_[static_cast<std::size_t>(place)];
  }

 private:
  static constexpr int kSteps = 1024;
  float nearest_;
  float farthest_;
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

/// Buffers of one row.
struct RowCounts {
  explicit RowCounts(std::size_t width) : step(width), companions(width), strangers(width) {}
  std::vector<float> step;
  std::vector<std::int32_t> companions;
  std::vector<std::int32_t> strangers;
};

/// Adds one neighbour of each pixel to the counts.
void count_neighbour(std::span<const float> centre, const float* neighbour, RowCounts& row) {
  const float* step = row.step.data();
  std::int32_t* companions = row.companions.data();
  std::int32_t* strangers = row.strangers.data();
  for (std::size_t u = 0; u < centre.size(); ++u) {
    const std::int32_t is_there = neighbour[u] > 0.0F ? 1 : 0;
    const std::int32_t is_near = std::abs(neighbour[u] - centre[u]) <= step[u] ? 1 : 0;
    companions[u] += is_there & is_near;
    strangers[u] += is_there & (1 - is_near);
  }
}

void filter_row(const DepthImage& padded, int v, const LargestSteps& steps, RowCounts& row,
                std::span<float> filtered) {
  const std::span<const float> centre = padded.row(v + 1).subspan(1, filtered.size());
  for (std::size_t u = 0; u < centre.size(); ++u) {
    row.step[u] = centre[u] > 0.0F ? steps.at(centre[u]) : 0.0F;
  }
  std::fill(row.companions.begin(), row.companions.end(), 0);
  std::fill(row.strangers.begin(), row.strangers.end(), 0);
  for (int dv = 0; dv <= 2; ++dv) {
    for (int du = 0; du <= 2; ++du) {
      if (du != 1 || dv != 1) count_neighbour(centre, padded.row(v + dv).data() + du, row);
    }
  }
  for (std::size_t u = 0; u < centre.size(); ++u) {
    const bool is_sound =
        row.companions[u] >= kLeastCompanions && row.strangers[u] <= kMostStrangers;
    filtered[u] = is_sound ? centre[u] : 0.0F;
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
                 RowCounts row(static_cast<std::size_t>(depth.width()));
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   filter_row(padded, v, steps, row, filtered.row(v));
                 }
               });
  return filtered;
}

}  // namespace pcavr
