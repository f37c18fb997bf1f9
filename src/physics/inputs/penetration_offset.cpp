// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "pcavr/base/core/median.hpp"

#include "physics/inputs/clock_offsets.hpp"
#include "physics/inputs/stream_gaps.hpp"

namespace pcavr {
namespace {

constexpr double kContactMargin = 5e-4;  // [m] a tip this near counts as in contact: by tracking
constexpr double kNear = 0.02;           // [m] within it, the force is along the direction inward
constexpr double kPenetrationRate = 200.0;  // [1/s] samples: enough for clocks
constexpr double kPerToolSample = 2.0;  // of a slow tool, between whose samples nothing is known
constexpr double kLoading = 0.015;  // [s] a force may lag the penetration without a clock offset

/// Error of meshes, poses and the tip's radius together [m]. Divided by the speed at the touch,
/// it is an error of the time of touch: some tenths of a second in slow pushes.
constexpr double kSurfaceError = 0.001;
constexpr double kFree = kContactMargin + kSurfaceError;  // [m]
constexpr double kMinTouchSpeed = 1e-4;                   // [m/s]
constexpr double kMaxStd = 0.05;                          // [s] of an offset that is known

/// The tip against the bodies' surfaces, on a grid from `begin` on.
struct Penetrations {
  double begin = 0.0;        ///< [s]
  double rate = 0.0;         ///< [1/s]
  std::vector<double> gaps;  ///< [m]
  std::vector<Eigen::Vector3d> inward_base;
  std::vector<bool> is_known;  ///< not between samples of the tool that lie far apart

  [[nodiscard]] double t(std::size_t k) const { return begin + static_cast<double>(k) / rate; }
};

/// [s] As pauses do not change it.
double median_interval(std::span<const double> t) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  return median(std::move(intervals));
}

Penetrations penetrations_of(const InputSeries& series, const PathView& tip,
                             const BodyPoses& poses) {
  const std::span<const double> t_tool = series.t_tool;
  const std::vector<StreamGap> tool_gaps = stream_gaps(t_tool);
  const double rate = std::min(kPenetrationRate, kPerToolSample / median_interval(t_tool));
  Penetrations result{t_tool.front(), rate, {}, {}, {}};
  const auto count = static_cast<std::size_t>((t_tool.back() - t_tool.front()) * rate) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    const double t = result.t(k);
    result.is_known.push_back(!is_in_gap(tool_gaps, t));
    Touch nearest;
    for (std::size_t i = 0; i < series.bodies.size(); ++i) {
      const Touch touch = poses.touch(i, t, tip.at(t), series.tool_radius);
      if (touch.gap < nearest.gap) nearest = touch;
    }
    result.gaps.push_back(nearest.gap);
    result.inward_base.emplace_back(nearest.gap < kNear ? nearest.inward_base
                                                        : Eigen::Vector3d(0.0, 0.0, 0.0));
  }
  return result;
}

/// Speed between kSurfaceError away from a surface and half as deep as the tip goes [m/s]: one that
/// slows down before it touches shows its time of touch as badly as one that is slow all the way.
/// `step`: 1 from `touch` on into the contact, -1 out of it. 0 where the free side is not there.
double edge_speed(const Penetrations& tip, std::size_t touch, double half, std::ptrdiff_t step) {
  const auto is_inside = [&](std::ptrdiff_t k) { return k >= 0 && k < std::ssize(tip.gaps); };
  const auto gap = [&](std::ptrdiff_t k) { return tip.gaps[static_cast<std::size_t>(k)]; };
  auto free = static_cast<std::ptrdiff_t>(touch);
  while (is_inside(free) && tip.is_known[static_cast<std::size_t>(free)] && gap(free) < kFree) {
    free -= step;
  }
  const bool is_found = is_inside(free) && tip.is_known[static_cast<std::size_t>(free)];
  if (!is_found || !std::isfinite(gap(free))) return 0.0;
  auto deep = static_cast<std::ptrdiff_t>(touch);
  while (gap(deep) > half) deep += step;
  return (gap(free) - gap(deep)) * tip.rate / static_cast<double>(std::abs(deep - free));
}

/// Of the faster one of approach and retreat, which dates the contact that begins at `touch`; a
/// recording may end before the retreat. 0 where neither is there [m/s].
double touch_speed(const Penetrations& tip, std::size_t touch) {
  std::size_t last = touch;
  double deepest = tip.gaps[touch];
  for (std::size_t k = touch; k < tip.gaps.size() && tip.gaps[k] < kFree; ++k) {
    if (tip.gaps[k] < kContactMargin) last = k;
    deepest = std::min(deepest, tip.gaps[k]);
  }
  const double half = 0.5 * (kContactMargin + deepest);
  return std::max(edge_speed(tip, touch, half, 1), edge_speed(tip, last, half, -1));
}

/// Median over the contacts [m/s]; 0 without one.
double touch_speed(const Penetrations& tip) {
  std::vector<double> speeds;
  bool is_free = true;
  for (std::size_t k = 0; k < tip.gaps.size(); ++k) {
    if (is_free && tip.gaps[k] < kContactMargin) {
      if (const double speed = touch_speed(tip, k); speed > 0.0) speeds.push_back(speed);
      is_free = false;
    }
    is_free = is_free || tip.gaps[k] > kFree;
  }
  return speeds.empty() ? 0.0 : median(std::move(speeds));
}

}  // namespace

bool is_significant(const TimeOffset& offset, double min_offset, const InputOptions& options) {
  return offset.is_known && std::abs(offset.offset) > min_offset &&
         std::abs(offset.offset) > options.min_offset_stds * offset.std;
}

TimeOffset penetration_offset(const InputSeries& series, const PathView& tip,
                              const BodyPoses& poses) {
  if (series.bodies.empty() || series.t_tool.size() < 2) return {};
  const Penetrations found = penetrations_of(series, tip, poses);
  std::vector<double> t, penetration;
  for (std::size_t k = 0; k < found.gaps.size(); ++k) {
    if (!found.is_known[k]) continue;
    t.push_back(found.t(k));
    penetration.push_back(std::max(kContactMargin - found.gaps[k], 0.0));
  }
  std::vector<double> t_force, along;
  for (std::size_t i = 0; i < series.t_force.size(); ++i) {
    const double index = (series.t_force[i] - found.begin) * found.rate;
    const bool is_beyond = index < 0.0 || index >= static_cast<double>(found.gaps.size());
    const auto k = is_beyond ? 0 : static_cast<std::size_t>(index);
    if (!is_beyond && !found.is_known[k]) continue;
    t_force.push_back(series.t_force[i]);
    along.push_back(is_beyond ? 0.0 : series.force_base[i].dot(found.inward_base[k]));
  }
  TimeOffset offset = estimate_time_offset(t, penetration, t_force, along);
  const double speed = std::max(touch_speed(found), kMinTouchSpeed);
  offset.std = std::hypot(offset.std, kLoading, kSurfaceError / speed);
  // A negative correlation is a matter of the sign, not of the clock.
  offset.is_known = offset.is_known && offset.correlation > 0.0 && offset.std < kMaxStd;
  return offset;
}

}  // namespace pcavr
