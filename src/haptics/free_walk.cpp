// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "haptics/free_walk.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

namespace pcavr::detail {
namespace {

/// A ball on a rugged surface rests on three; more are ties and neighbours of the same edge.
constexpr std::size_t kMaxTouching = 24;
/// Each leg meets one more half-space, and three stop the ball.
constexpr int kMaxLegs = 10;
/// Of a direction: what rounding makes of a motion along a plane.
constexpr double kAlong = 1e-9;

struct Touching {
  std::array<Eigen::Vector3d, kMaxTouching> normal;
  std::size_t count = 0;

  [[nodiscard]] bool allow(const Eigen::Vector3d& direction) const noexcept {
    const double least = -kAlong * direction.norm();
    return std::all_of(normal.begin(), normal.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const Eigen::Vector3d& n) { return n.dot(direction) >= least; });
  }
};

}  // namespace

Eigen::Vector3d allowed(const Eigen::Vector3d& wish,
                        std::span<const HalfSpace> half_spaces) noexcept {
  Touching touching;
  for (const HalfSpace& half_space : half_spaces) {
    if (half_space.slack > kTouching) continue;
    if (touching.count == kMaxTouching) return Eigen::Vector3d::Zero();
    touching.normal[touching.count++] = half_space.normal;
  }
  if (touching.allow(wish)) return wish;
  // The projection lies on a face of the cone, or on an edge where two faces meet.
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  const auto consider = [&](const Eigen::Vector3d& direction) {
    if (direction.squaredNorm() > best.squaredNorm() && touching.allow(direction)) best = direction;
  };
  for (std::size_t i = 0; i < touching.count; ++i) {
    const Eigen::Vector3d& n = touching.normal[i];
    if (n.dot(wish) < 0.0) consider(wish - n.dot(wish) * n);
  }
  if (!best.isZero(0.0)) return best;
  for (std::size_t i = 0; i < touching.count; ++i) {
    for (std::size_t j = i + 1; j < touching.count; ++j) {
      const Eigen::Vector3d edge = touching.normal[i].cross(touching.normal[j]);
      const double size2 = edge.squaredNorm();
      if (size2 > kAlong * kAlong) consider(edge.dot(wish) / size2 * edge);
    }
  }
  return best;
}

Eigen::Vector3d walk(const Eigen::Vector3d& from, const Eigen::Vector3d& goal,
                     std::span<HalfSpace> half_spaces, double& budget) noexcept {
  Eigen::Vector3d x = from;
  for (int leg = 0; leg < kMaxLegs && budget > 0.0; ++leg) {
    const Eigen::Vector3d wish = goal - x;
    const Eigen::Vector3d way = allowed(wish, half_spaces);
    const double length = way.norm();
    if (length <= kTouching) break;
    double share = 1.0;
    for (const HalfSpace& half_space : half_spaces) {
      const double closing = -half_space.normal.dot(way);
      if (half_space.slack > kTouching && closing * share > half_space.slack) {
        share = half_space.slack / closing;
      }
    }
    share = std::min(share, budget / length);
    const bool arrives = share >= 1.0 && way == wish;
    x = arrives ? goal : Eigen::Vector3d(x + share * way);
    budget = std::max(budget - share * length, 0.0);
    for (HalfSpace& half_space : half_spaces) {
      half_space.slack = std::max(half_space.slack + share * half_space.normal.dot(way), 0.0);
    }
    if (arrives) break;
  }
  return x;
}

}  // namespace pcavr::detail
