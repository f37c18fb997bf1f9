// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/unrecorded_moves.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace pcavr {
namespace {

// [s] Smallest gap: no push goes far in a shorter one.
constexpr double kMinGap = 0.2;
// [s] Time over which the speeds before and after a gap are measured.
constexpr double kSpeedTime = 0.1;
// Largest mean speed in a gap over the faster of both speeds: a push that goes on through the gap
// stays below.
constexpr double kMaxSpeedRatio = 2.0;
// [m] Largest move of a tip that only settles.
constexpr double kMinMove = 0.005;
// [m] Distance between the tip and the highest object.
constexpr double kClearance = 0.02;
// Share of the gap for each of lifting and lowering.
constexpr double kVerticalShare = 0.25;

double speed_before(const TipPath& tip, std::size_t i) {
  std::size_t from = i;
  while (from > 0 && tip.t[i] - tip.t[from] < kSpeedTime) --from;
  return from < i ? (tip.p_base[i] - tip.p_base[from]).norm() / (tip.t[i] - tip.t[from]) : 0.0;
}

double speed_after(const TipPath& tip, std::size_t i) {
  std::size_t to = i;
  while (to + 1 < tip.t.size() && tip.t[to] - tip.t[i] < kSpeedTime) ++to;
  return to > i ? (tip.p_base[to] - tip.p_base[i]).norm() / (tip.t[to] - tip.t[i]) : 0.0;
}

/// A step from 0 to 1, without speed at both ends.
double smooth_step(double u) {
  const double x = std::clamp(u, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

}  // namespace

std::vector<UnrecordedMove> find_unrecorded_moves(const TipPath& tip) {
  std::vector<UnrecordedMove> moves;
  for (std::size_t i = 0; i + 1 < tip.t.size(); ++i) {
    const double gap = tip.t[i + 1] - tip.t[i];
    if (gap < kMinGap) continue;
    const double speed = std::max(speed_before(tip, i), speed_after(tip, i + 1));
    const double path = (tip.p_base[i + 1] - tip.p_base[i]).norm();
    if (path < kMinMove + kMaxSpeedRatio * speed * gap) continue;
    moves.push_back({tip.t[i], tip.t[i + 1], tip.p_base[i], tip.p_base[i + 1]});
  }
  return moves;
}

double height_over_objects(const TeleopInput& input) {
  double top = -std::numeric_limits<double>::infinity();
  for (const TeleopObject& object : input.objects) {
    for (const Eigen::Vector3f& vertex : object.model.mesh_object.vertices) {
      top = std::max(top, (object.T_base_object * vertex.cast<double>()).z());
    }
  }
  return top + input.tool_radius + kClearance;
}

Eigen::Vector3d p_base_over_objects(const UnrecordedMove& move, double height, double t) {
  const double u = (t - move.begin) / (move.end - move.begin);
  const double across = smooth_step((u - kVerticalShare) / (1.0 - 2.0 * kVerticalShare));
  Eigen::Vector3d p_base = move.p_base_from + across * (move.p_base_to - move.p_base_from);
  const bool is_first_half = u < 0.5;
  const double end_height = is_first_half ? move.p_base_from.z() : move.p_base_to.z();
  const double lift = smooth_step(std::min(u, 1.0 - u) / kVerticalShare);
  const double top = std::max({height, move.p_base_from.z(), move.p_base_to.z()});
  p_base.z() = end_height + lift * (top - end_height);
  return p_base;
}

}  // namespace pcavr
