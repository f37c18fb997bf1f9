// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pcavr/base/model/triangle.hpp"
#include "pcavr/robots/robot/robot_collision.hpp"

namespace pcavr {
namespace {

constexpr double kSmallest = 1e-18;  ///< [m^2] shorter segments are points

void keep_nearer(const SegmentDistance& candidate, SegmentDistance& best) {
  if (candidate.squared < best.squared) best = candidate;
}

SegmentDistance between(const Eigen::Vector3d& on_segment, const Eigen::Vector3d& on_other) {
  return {(on_segment - on_other).squaredNorm(), on_segment, on_other};
}

/// Whether the segment passes through the triangle; `at` is the point where it does.
bool intersects(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const model::Triangle& triangle,
                Eigen::Vector3d& at) {
  const Eigen::Vector3d normal = triangle.doubled_area_normal();
  const double above_a = normal.dot(a - triangle.a);
  const double above_b = normal.dot(b - triangle.a);
  if (above_a * above_b > 0.0 || above_a == above_b) return false;
  at = a + (b - a) * (above_a / (above_a - above_b));
  const auto is_left = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return (to - from).cross(at - from).dot(normal) >= 0.0;
  };
  return is_left(triangle.a, triangle.b) && is_left(triangle.b, triangle.c) &&
         is_left(triangle.c, triangle.a);
}

}  // namespace

SegmentDistance segment_segment_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                         const Eigen::Vector3d& c,
                                         const Eigen::Vector3d& d) noexcept {
  const Eigen::Vector3d first = b - a;
  const Eigen::Vector3d second = d - c;
  const Eigen::Vector3d between_starts = a - c;
  const double first2 = first.squaredNorm();
  const double second2 = second.squaredNorm();
  const double f = second.dot(between_starts);
  double s = 0.0;
  double t = 0.0;
  if (first2 <= kSmallest && second2 <= kSmallest) return between(a, c);
  if (first2 <= kSmallest) {
    t = std::clamp(f / second2, 0.0, 1.0);
  } else {
    const double e = first.dot(between_starts);
    if (second2 <= kSmallest) {
      s = std::clamp(-e / first2, 0.0, 1.0);
    } else {
      const double dot = first.dot(second);
      const double denominator = first2 * second2 - dot * dot;
      if (denominator > 0.0) s = std::clamp((dot * f - e * second2) / denominator, 0.0, 1.0);
      t = (dot * s + f) / second2;
      if (t < 0.0 || t > 1.0) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((dot * t - e) / first2, 0.0, 1.0);
      }
    }
  }
  return between(a + s * first, c + t * second);
}

SegmentDistance segment_triangle_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                          const std::array<Eigen::Vector3d, 3>& corners) noexcept {
  const model::Triangle triangle{corners[0], corners[1], corners[2]};
  Eigen::Vector3d at;
  if (intersects(a, b, triangle, at)) return between(at, at);
  SegmentDistance best = segment_segment_distance(a, b, triangle.a, triangle.b);
  keep_nearer(segment_segment_distance(a, b, triangle.b, triangle.c), best);
  keep_nearer(segment_segment_distance(a, b, triangle.c, triangle.a), best);
  keep_nearer(between(a, model::closest_point(triangle, a)), best);
  keep_nearer(between(b, model::closest_point(triangle, b)), best);
  return best;
}

}  // namespace pcavr
