// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/region.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcavr/base/geometry/pixel.hpp"

namespace pcavr {
namespace {

/// Margin for motion that scales with the tag's size [share of it]: half a tag from frame to frame.
constexpr double kTagShare = 0.5;
constexpr int kGrid = 8;  ///< [px] see regions_around

Region region_around(const std::array<Eigen::Vector2d, 4>& corners, int width, int height,
                     double motion_share) {
  double left = corners[0].x(), right = left, top = corners[0].y(), bottom = top;
  for (const Eigen::Vector2d& corner : corners) {
    left = std::min(left, corner.x());
    right = std::max(right, corner.x());
    top = std::min(top, corner.y());
    bottom = std::max(bottom, corner.y());
  }
  const double margin = motion_share * width + kTagShare * std::max(right - left, bottom - top);
  return {clamp_to_int(left - margin, 0, width) / kGrid * kGrid,
          clamp_to_int(top - margin, 0, height) / kGrid * kGrid,
          clamp_to_int(right + margin + 1.0, 0, width),
          clamp_to_int(bottom + margin + 1.0, 0, height)};
}

bool overlap(const Region& a, const Region& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

Region merged(const Region& a, const Region& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

}  // namespace

std::vector<Region> regions_around(const std::vector<std::array<Eigen::Vector2d, 4>>& tags,
                                   int width, int height, double motion_share) {
  std::vector<Region> regions;
  for (const auto& corners : tags) {
    Region region = region_around(corners, width, height, motion_share);
    // A merged region may overlap others in turn.
    for (std::size_t i = 0; i < regions.size();) {
      if (!overlap(region, regions[i])) {
        ++i;
        continue;
      }
      region = merged(region, regions[i]);
      regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    }
    regions.push_back(region);
  }
  return regions;
}

}  // namespace pcavr
