// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/reconstruction/depth_filter.hpp"

#include <cmath>
#include <numbers>

namespace pcavr {
namespace {

constexpr std::size_t kGrainRows = 16;
// Steeper than this the reading is more guess than measurement [Nguyen et al. 2012: the noise
// grows without bound from 70 to 80 deg].
constexpr double kSteepest = 80.0 * std::numbers::pi / 180.0;
// A straight edge leaves five of eight neighbours, a corner three; a gross error has none.
constexpr int kLeastCompanions = 3;
// A jump along an edge disagrees with three neighbours, a lone gross error with one.
constexpr int kMostStrangers = 1;

/// Largest difference in depth between neighbouring pixels of one surface [m].
float largest_step(float z, const CameraModel& camera, const DepthNoise& noise) {
  const double slope = z / camera.fx * std::tan(kSteepest);
  return static_cast<float>(3.0 * std::numbers::sqrt2 * noise.sigma(z) + slope);
}

bool is_sound(const DepthImage& depth, int u, int v, const CameraModel& camera,
              const DepthNoise& noise) {
  const float z = depth(u, v);
  const float step = largest_step(z, camera, noise);
  int companions = 0;
  int strangers = 0;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      if ((du == 0 && dv == 0) || !depth.contains(u + du, v + dv)) continue;
      const float other = depth(u + du, v + dv);
      if (!(other > 0.0F)) continue;
      (std::abs(other - z) <= step ? companions : strangers) += 1;
    }
  }
  return companions >= kLeastCompanions && strangers <= kMostStrangers;
}

}  // namespace

DepthImage filter_depth(const DepthImage& depth, const CameraModel& camera, const DepthNoise& noise,
                        Parallelism parallelism) {
  DepthImage filtered(depth.width(), depth.height());
  parallel_for(parallelism, static_cast<std::size_t>(depth.height()), kGrainRows,
               [&](std::size_t begin, std::size_t end) {
                 for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                   for (int u = 0; u < depth.width(); ++u) {
                     const float z = depth(u, v);
                     // Also false for NaN.
                     const bool in_range = z >= static_cast<float>(noise.nearest) &&
                                           z <= static_cast<float>(noise.farthest);
                     if (in_range && is_sound(depth, u, v, camera, noise)) filtered(u, v) = z;
                   }
                 }
               });
  return filtered;
}

}  // namespace pcavr
