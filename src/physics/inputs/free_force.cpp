// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/free_force.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pcavr/base/core/median.hpp"

namespace pcavr {
namespace {

/// [m] More than poses and clocks are off: a tip at 0.1 m/s travels so far in 0.3 s.
constexpr double kFarGap = 0.03;
constexpr double kFreeInterval = 0.01;       // [s] at which the tip's distance is found
constexpr std::size_t kMinFreeSamples = 20;  // 0.2 s
/// [N] A smaller bias is followed without the bodies' poses.
constexpr double kMinBias = 1.0;
/// Smallest share of the samples that must lie near the median: within a distance [N], or a share
/// of the bias. A tool that is not compensated for its weight has another force in another
/// orientation.
constexpr double kMinFreeShare = 0.7;
constexpr double kMaxFreeDistance = 1.0;
constexpr double kMaxRelativeDistance = 0.1;

}  // namespace

std::optional<Eigen::Vector3d> free_force(const InputSeries& series, const PathView& tip,
                                          const BodyPoses& poses) {
  std::vector<Eigen::Vector3d> far;
  double next = -HUGE_VAL;
  for (std::size_t i = 0; i < series.t_force.size(); ++i) {
    const double t = series.t_force[i];
    if (t < next || t < tip.t().front() || t > tip.t().back()) continue;
    next = t + kFreeInterval;
    const Eigen::Vector3d p_base_tip = tip.at(t);
    bool is_far = !series.bodies.empty();
    for (std::size_t body = 0; is_far && body < series.bodies.size(); ++body) {
      is_far = poses.touch(body, t, p_base_tip, series.tool_radius).gap > kFarGap;
    }
    if (is_far) far.push_back(series.force_base[i]);
  }
  if (far.size() < kMinFreeSamples) return std::nullopt;
  Eigen::Vector3d level;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Eigen::Vector3d& force : far) values.push_back(force[k]);
    level[k] = median(std::move(values));
  }
  if (level.norm() < kMinBias) return std::nullopt;
  const double near = std::max(kMaxFreeDistance, kMaxRelativeDistance * level.norm());
  const auto count = std::count_if(far.begin(), far.end(), [&](const Eigen::Vector3d& force) {
    return (force - level).norm() < near;
  });
  if (static_cast<double>(count) < kMinFreeShare * static_cast<double>(far.size()))
    return std::nullopt;
  return level;
}

}  // namespace pcavr
