// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/convex_hull.hpp"

#include <algorithm>
#include <tuple>

namespace pcavr {
namespace {

/// The lower or upper chain of Andrew's monotone chain algorithm [Andrew 1979]; the last point is
/// left out.
template <typename Iterator>
void append_chain(Iterator begin, Iterator end, std::vector<Eigen::Vector3d>& hull) {
  const std::size_t first = hull.size();
  for (Iterator point = begin; point != end; ++point) {
    while (hull.size() >= first + 2 &&
           orientation_xy(hull[hull.size() - 2], hull.back(), *point) <= 0.0) {
      hull.pop_back();
    }
    hull.push_back(*point);
  }
  hull.pop_back();
}

}  // namespace

std::vector<Eigen::Vector3d> convex_hull_xy(std::vector<Eigen::Vector3d> points) {
  if (points.empty()) return points;
  std::sort(points.begin(), points.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::tuple(a.x(), a.y()) < std::tuple(b.x(), b.y());
  });
  std::vector<Eigen::Vector3d> hull;
  append_chain(points.begin(), points.end(), hull);
  append_chain(points.rbegin(), points.rend(), hull);
  return hull;
}

}  // namespace pcavr
