// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/press_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/sliding.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinPressSamples = 20;
constexpr int kConsecutiveBelow = 3;  // samples that confirm the mutation, as the alarm's
// Share of the alarm's force below which noise and the first touch govern.
constexpr double kFromShare = 0.15;

struct Point {
  double tool = 0.0, penetration = 0.0;  ///< [m]
};

/// Penetration by the press's law over the tool's coordinate, at rest: slope 1 if the law holds.
struct Regression {
  std::size_t count = 0;
  double tool = 0.0, penetration = 0.0;  ///< means [m]
  double slope = 0.0, slope_std = 0.0;
};

Regression regress(const std::vector<Point>& points, double correlated) {
  Regression r;
  r.count = points.size();
  const auto n = static_cast<double>(r.count);
  for (const Point& point : points) {
    r.tool += point.tool / n, r.penetration += point.penetration / n;
  }
  double spread = 0.0, product = 0.0, squares = 0.0;
  for (const Point& point : points) {
    spread += std::pow(point.tool - r.tool, 2);
    product += (point.tool - r.tool) * (point.penetration - r.penetration);
  }
  if (!(spread > 0.0)) return {};
  r.slope = product / spread;
  for (const Point& point : points) {
    const double line = r.penetration + r.slope * (point.tool - r.tool);
    squares += std::pow(point.penetration - line, 2);
  }
  r.slope_std = std::sqrt(squares * correlated / std::max(n - 2.0, 1.0) / spread);
  return r;
}

}  // namespace

std::vector<double> press_line_force(const ForceMotion& push, double surface,
                                     const HuntCrossley& press) {
  std::vector<double> force;
  force.reserve(push.tool.size());
  for (const double tool : push.tool) force.push_back(elastic_force(press, tool - surface));
  return force;
}

PressLine compare_with_press(const ForceMotion& push, const Breakaway& found,
                             const HuntCrossley& press, const BreakawayOptions& options) {
  PCAVR_REQUIRE(push.t.size() == push.tool.size() && push.t.size() == push.force.size());
  PCAVR_REQUIRE(press.stiffness > 0.0 && press.exponent >= 1.0);
  PressLine result;
  if (!found.is_found || push.t.size() < 2 * kMinPressSamples) return result;
  const double interval = mean_interval(push.t);
  const double half_width = std::max(options.half_width, 3.0 * interval);
  const std::vector<double> raw = remove_spikes(push.force).values;
  const std::vector<SmoothedSample> force = smooth(push.t, raw, push.t, half_width);
  const std::vector<SmoothedSample> tool = smooth(push.t, push.tool, push.t, half_width);
  const double correlated = correlated_samples(half_width, interval);
  const double noise = estimate_noise_std(raw) / std::sqrt(correlated);
  const std::vector<double> penetration = penetration_from_force(push.t, raw, press);

  std::vector<Point> rise, first_half;
  for (std::size_t i = 0; i < push.t.size(); ++i) {
    if (push.t[i] < found.t_contact || push.t[i] > found.t_alarm - options.guard) continue;
    if (!force[i].is_valid || force[i].value < kFromShare * found.force) continue;
    const Point point{push.tool[i], penetration[i]};
    rise.push_back(point);
    if (force[i].value < 0.5 * found.force) first_half.push_back(point);
  }
  if (rise.size() < kMinPressSamples || first_half.size() < kMinPressSamples / 4) return result;
  // The penetration is made from the unsmoothed force: its noise is white.
  const Regression line = regress(rise, 1.0);
  if (!(line.slope > 0.0)) return result;
  result.ratio.value = std::pow(line.slope, press.exponent);
  result.ratio.std = result.ratio.value * press.exponent * line.slope_std / line.slope;
  result.ratio.is_excited = true;
  const Regression early = regress(first_half, 1.0);
  result.surface = early.tool - early.penetration;

  int consecutive = 0;
  for (std::size_t i = 0; i < push.t.size() && !result.t_mutation; ++i) {
    if (push.t[i] < found.t_contact || !force[i].is_valid || !tool[i].is_valid) continue;
    const double predicted = elastic_force(press, tool[i].value - result.surface);
    const double shortfall = predicted - force[i].value;
    const bool is_below =
        shortfall > options.alarm_threshold * noise && shortfall > options.alarm_share * predicted;
    consecutive = is_below ? consecutive + 1 : 0;
    if (consecutive < kConsecutiveBelow) continue;
    result.t_mutation = push.t[i];
    result.force = force[i].value;
  }
  return result;
}

}  // namespace pcavr
