// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/triangle.hpp"

#include <algorithm>

namespace pcavr::model {
namespace {

Eigen::Vector3d closest_on_segment(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                   const Eigen::Vector3d& point) {
  const Eigen::Vector3d along = to - from;
  const double squared_length = along.squaredNorm();
  if (!(squared_length > 0.0)) return from;
  return from + std::clamp((point - from).dot(along) / squared_length, 0.0, 1.0) * along;
}

}  // namespace

Eigen::Vector3d closest_point(const Triangle& triangle, const Eigen::Vector3d& point) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d normal = triangle.doubled_area_normal();
  // Twice the areas of the sub-triangles opposite to each corner, seen along the normal: all
  // positive where the point projects into the triangle.
  const double area_a = normal.dot((b - point).cross(c - point));
  const double area_b = normal.dot((c - point).cross(a - point));
  const double area_c = normal.dot((a - point).cross(b - point));
  const double area = area_a + area_b + area_c;
  if (area > 0.0 && area_a >= 0.0 && area_b >= 0.0 && area_c >= 0.0) {
    return (area_a * a + area_b * b + area_c * c) / area;
  }
  Eigen::Vector3d nearest = closest_on_segment(a, b, point);
  for (const Eigen::Vector3d& candidate :
       {closest_on_segment(b, c, point), closest_on_segment(c, a, point)}) {
    if ((candidate - point).squaredNorm() < (nearest - point).squaredNorm()) nearest = candidate;
  }
  return nearest;
}

}  // namespace pcavr::model
