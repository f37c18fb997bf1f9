// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "convex_outline.hpp"

#include <cstddef>
#include <utility>

#include "pcavr/geometry/convex_hull.hpp"

namespace pcavr {
namespace {

constexpr double kMinCorner = 0.002;  ///< height of a corner over its neighbours' line [m]

/// Takes the flattest corner away as long as it is flat enough.
void drop_flat_corners(std::vector<Eigen::Vector3d>& outline) {
  while (outline.size() > 3) {
    const auto height = [&](std::size_t i) {
      const Eigen::Vector3d& before = outline[(i + outline.size() - 1) % outline.size()];
      const Eigen::Vector3d& after = outline[(i + 1) % outline.size()];
      return turn_from_above(before, outline[i], after) / (after - before).head<2>().norm();
    };
    std::size_t flattest = 0;
    for (std::size_t i = 1; i < outline.size(); ++i) {
      if (height(i) < height(flattest)) flattest = i;
    }
    if (height(flattest) >= kMinCorner) return;
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
  std::vector<Eigen::Vector3d> outline = convex_hull_from_above(std::move(on_plane));
  drop_flat_corners(outline);
  return outline;
}

bool is_above_outline(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector3d& point) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (turn_from_above(outline[i], outline[(i + 1) % outline.size()], point) < 0.0) return false;
  }
  return outline.size() >= 3;
}

}  // namespace pcavr
