// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "convex_outline.hpp"

#include <cstddef>
#include <utility>

#include "pcavr/base/geometry/convex_hull.hpp"

namespace pcavr {
namespace {

constexpr double kMinCornerHeight = 0.002;  ///< distance of a corner from its neighbours' line [m]

/// Simplifies the outline: removes the flattest corner while it is below kMinCornerHeight.
void remove_flat_corners(std::vector<Eigen::Vector3d>& outline) {
  while (outline.size() > 3) {
    const auto height = [&](std::size_t i) {
      const Eigen::Vector3d& before = outline[(i + outline.size() - 1) % outline.size()];
      const Eigen::Vector3d& after = outline[(i + 1) % outline.size()];
      return orientation_xy(before, outline[i], after) / (after - before).head<2>().norm();
    };
    std::size_t flattest = 0;
    for (std::size_t i = 1; i < outline.size(); ++i) {
      if (height(i) < height(flattest)) flattest = i;
    }
    if (height(flattest) >= kMinCornerHeight) return;
    outline.erase(outline.begin() + static_cast<std::ptrdiff_t>(flattest));
  }
}

}  // namespace

std::vector<Eigen::Vector3d> convex_outline(const std::vector<Eigen::Vector3d>& points,
                                            const Plane& plane) {
  std::vector<Eigen::Vector3d> on_plane;
  on_plane.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    on_plane.push_back(point - plane.signed_distance(point) * plane.normal);
  }
  std::vector<Eigen::Vector3d> outline = convex_hull_xy(std::move(on_plane));
  remove_flat_corners(outline);
  return outline;
}

bool is_above_outline(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector3d& point) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (orientation_xy(outline[i], outline[(i + 1) % outline.size()], point) < 0.0) return false;
  }
  return outline.size() >= 3;
}

}  // namespace pcavr
