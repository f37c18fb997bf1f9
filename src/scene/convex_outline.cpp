// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "convex_outline.hpp"

#include <algorithm>
#include <tuple>

namespace pcavr {
namespace {

constexpr double kLeastCorner = 0.002;  ///< height of a corner over its neighbours' line [m]

/// Twice the area of the triangle from above; positive where the corners turn left.
double turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// One of the two chains of the hull [Andrew 1979]; the last point is left out.
template <typename Iterator>
void append_chain(Iterator begin, Iterator end, std::vector<Eigen::Vector3d>& hull) {
  const std::size_t first = hull.size();
  for (Iterator point = begin; point != end; ++point) {
    while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), *point) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(*point);
  }
  hull.pop_back();
}

/// Takes the flattest corner away as long as it is flat enough.
void drop_flat_corners(std::vector<Eigen::Vector3d>& outline) {
  while (outline.size() > 3) {
    const auto height = [&](std::size_t i) {
      const Eigen::Vector3d& before = outline[(i + outline.size() - 1) % outline.size()];
      const Eigen::Vector3d& after = outline[(i + 1) % outline.size()];
      return turn(before, outline[i], after) / (after - before).head<2>().norm();
    };
    std::size_t flattest = 0;
    for (std::size_t i = 1; i < outline.size(); ++i) {
      if (height(i) < height(flattest)) flattest = i;
    }
    if (height(flattest) >= kLeastCorner) return;
    outline.erase(outline.begin() + static_cast<std::ptrdiff_t>(flattest));
  }
}

}  // namespace

std::vector<Eigen::Vector3d> convex_outline(const std::vector<Eigen::Vector3d>& points,
                                            const Plane& plane) {
  std::vector<Eigen::Vector3d> sorted;
  sorted.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    sorted.push_back(point - plane.signed_distance(point) * plane.normal);
  }
  std::sort(sorted.begin(), sorted.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::tuple(a.x(), a.y()) < std::tuple(b.x(), b.y());
  });
  std::vector<Eigen::Vector3d> outline;
  append_chain(sorted.begin(), sorted.end(), outline);
  append_chain(sorted.rbegin(), sorted.rend(), outline);
  drop_flat_corners(outline);
  return outline;
}

bool is_above_outline(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector3d& point) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (turn(outline[i], outline[(i + 1) % outline.size()], point) < 0.0) return false;
  }
  return outline.size() >= 3;
}

}  // namespace pcavr
