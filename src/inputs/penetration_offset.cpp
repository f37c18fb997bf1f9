// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pcavr/core/median.hpp"

#include "inputs/clock_offsets.hpp"

namespace pcavr {
namespace {

constexpr double kContactMargin = 5e-4;  // [m] a tip this near counts as in contact: by tracking
constexpr double kNear = 0.02;           // [m] within it, the force is along the direction inward
constexpr double kPenetrationRate = 200.0;  // [1/s] samples: enough for clocks
constexpr double kLoading = 0.015;  // [s] a force may lag the penetration without a clock offset

/// [m] of meshes, poses and the tip's radius together. Divided by the speed of the approach, it is
/// an error of the time of touch: some tenths of a second in slow pushes.
constexpr double kSurfaceError = 0.001;
constexpr std::size_t kApproachSamples = 10;  // [grid steps] of the approach before a touch
constexpr double kMinApproachSpeed = 1e-4;    // [m/s]
constexpr double kMaxStd = 0.05;              // [s] of an offset that is known

/// Median speed at which the tip approaches the bodies before it touches them [m/s].
double approach_speed(const std::vector<double>& gaps) {
  std::vector<double> speeds;
  std::size_t free = 0;
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    const bool touches = gaps[k] < kContactMargin;
    if (touches && free >= kApproachSamples) {
      speeds.push_back((gaps[k - kApproachSamples] - gaps[k]) * kPenetrationRate /
                       static_cast<double>(kApproachSamples));
    }
    free = touches ? 0 : free + 1;
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
  if (series.bodies.empty() || series.t_tool.empty()) return {};
  const double begin = series.t_tool.front();
  const auto count =
      static_cast<std::size_t>((series.t_tool.back() - begin) * kPenetrationRate) + 1;
  std::vector<double> t, gaps, penetration;
  std::vector<Eigen::Vector3d> inward_base;
  for (std::size_t k = 0; k < count; ++k) {
    t.push_back(begin + static_cast<double>(k) / kPenetrationRate);
    Touch nearest;
    for (std::size_t i = 0; i < series.bodies.size(); ++i) {
      const Touch touch = poses.touch(i, t.back(), tip.at(t.back()), series.tool_radius);
      if (touch.gap < nearest.gap) nearest = touch;
    }
    gaps.push_back(nearest.gap);
    penetration.push_back(std::max(kContactMargin - nearest.gap, 0.0));
    inward_base.emplace_back(nearest.gap < kNear ? nearest.inward_base
                                                 : Eigen::Vector3d(0.0, 0.0, 0.0));
  }
  std::vector<double> along(series.t_force.size(), 0.0);
  for (std::size_t i = 0; i < along.size(); ++i) {
    const double index = (series.t_force[i] - begin) * kPenetrationRate;
    if (index < 0.0 || index >= static_cast<double>(count)) continue;
    along[i] = series.force_base[i].dot(inward_base[static_cast<std::size_t>(index)]);
  }
  TimeOffset offset = estimate_time_offset(t, penetration, series.t_force, along);
  const double speed = std::max(approach_speed(gaps), kMinApproachSpeed);
  offset.std = std::hypot(offset.std, kLoading, kSurfaceError / speed);
  // A negative correlation is a matter of the sign, not of the clock.
  offset.is_known = offset.is_known && offset.correlation > 0.0 && offset.std < kMaxStd;
  return offset;
}

}  // namespace pcavr
