// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/constrained_motion.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

namespace pcavr::detail {
namespace {

/// A sphere on a rough surface has three contacts; more are ties and neighbours of the same edge.
constexpr std::size_t kMaxContacts = 24;
/// Each straight segment ends at one more half-space, and three stop the sphere.
constexpr int kMaxSegments = 10;
/// Relative to a direction's length: rounding of a motion along a plane.
constexpr double kTangentTolerance = 1e-9;

struct ActiveConstraints {
  std::array<Eigen::Vector3d, kMaxContacts> normal;
  std::size_t count = 0;

  [[nodiscard]] bool allow(const Eigen::Vector3d& direction) const noexcept {
    const double min_dot = -kTangentTolerance * direction.norm();
    return std::all_of(normal.begin(), normal.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const Eigen::Vector3d& n) { return n.dot(direction) >= min_dot; });
  }
};

}  // namespace

Eigen::Vector3d project_on_cone(const Eigen::Vector3d& desired,
                                std::span<const HalfSpace> half_spaces) noexcept {
  ActiveConstraints active;
  for (const HalfSpace& half_space : half_spaces) {
    if (half_space.slack > kContactSlack) continue;
    if (active.count == kMaxContacts) return Eigen::Vector3d::Zero();
    active.normal[active.count++] = half_space.normal;
  }
  if (active.allow(desired)) return desired;
  // The projection lies on a face of the cone, or on an edge where two faces meet.
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  const auto try_candidate = [&](const Eigen::Vector3d& direction) {
    if (direction.squaredNorm() > best.squaredNorm() && active.allow(direction)) best = direction;
  };
  for (std::size_t i = 0; i < active.count; ++i) {
    const Eigen::Vector3d& n = active.normal[i];
    if (n.dot(desired) < 0.0) try_candidate(desired - n.dot(desired) * n);
  }
  if (!best.isZero(0.0)) return best;
  for (std::size_t i = 0; i < active.count; ++i) {
    for (std::size_t j = i + 1; j < active.count; ++j) {
      const Eigen::Vector3d edge = active.normal[i].cross(active.normal[j]);
      const double squared_norm = edge.squaredNorm();
      if (squared_norm > kTangentTolerance * kTangentTolerance)
        try_candidate(edge.dot(desired) / squared_norm * edge);
    }
  }
  return best;
}

Eigen::Vector3d move_constrained(const Eigen::Vector3d& from, const Eigen::Vector3d& goal,
                                 std::span<HalfSpace> half_spaces, double& budget) noexcept {
  Eigen::Vector3d x = from;
  for (int segment = 0; segment < kMaxSegments && budget > 0.0; ++segment) {
    const Eigen::Vector3d desired = goal - x;
    const Eigen::Vector3d motion = project_on_cone(desired, half_spaces);
    const double length = motion.norm();
    if (length <= kContactSlack) break;
    double share = 1.0;
    for (const HalfSpace& half_space : half_spaces) {
      const double closing = -half_space.normal.dot(motion);
      if (half_space.slack > kContactSlack && closing * share > half_space.slack) {
        share = half_space.slack / closing;
      }
    }
    share = std::min(share, budget / length);
    const bool arrives = share >= 1.0 && motion == desired;
    x = arrives ? goal : Eigen::Vector3d(x + share * motion);
    budget = std::max(budget - share * length, 0.0);
    for (HalfSpace& half_space : half_spaces) {
      half_space.slack = std::max(half_space.slack + share * half_space.normal.dot(motion), 0.0);
    }
    if (arrives) break;
  }
  return x;
}

}  // namespace pcavr::detail
