// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/touch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {
namespace {

constexpr double kFree = 0.4;  // [s] before the first sure contact that the fit uses
constexpr std::size_t kMinRise = 4;
constexpr double kMaxTouchExponent = 2.5;  // a cone has 2; beyond, noise is fitted
// Below this share of its speed at the touch, both averaged over kSpeedWindow, the tool is
// stopping.
constexpr double kStoppingShare = 0.5;
constexpr double kSpeedWindow = 0.05;  // [s]

/// Depth and force of the rise, in the order of the approach.
struct Rise {
  std::vector<double> t, tool, force;
  double max_surface = 0.0;  ///< [m] the surface is no deeper
};

/// Sum of squares about F = f0 + a (d - surface)^n with the best f0 and a.
double misfit(const Rise& rise, double surface, double exponent) {
  const double unit = std::max(rise.tool.back() - surface, 1e-9);
  const double n = static_cast<double>(rise.tool.size());
  double p = 0.0, pp = 0.0, f = 0.0, pf = 0.0, ff = 0.0;
  for (std::size_t i = 0; i < rise.tool.size(); ++i) {
    const double depth = (rise.tool[i] - surface) / unit;
    const double power = penetration_power(depth, exponent);
    p += power, pp += power * power;
    f += rise.force[i], pf += power * rise.force[i], ff += rise.force[i] * rise.force[i];
  }
  const double spread = pp - p * p / n;
  const double cross = pf - p * f / n;
  return ff - f * f / n - (spread > 0.0 ? cross * cross / spread : 0.0);
}

/// The minimum of `cost` in [low, high] to within `tolerance`, by parabolas and golden sections
/// [Brent 1973, Algorithms for Minimization without Derivatives, ch. 5]: where, and its value.
template <typename Cost>
std::pair<double, double> minimise(const Cost& cost, double low, double high, double tolerance) {
  constexpr double kGolden = 0.3819660112501051;
  constexpr int kMaxSteps = 40;  // golden sections alone need 20 for 1e-4 of the range
  double x = low + kGolden * (high - low), w = x, v = x;  // the best, the second, the one before
  double at_x = cost(x), at_w = at_x, at_v = at_x;
  double step = 0.0, before = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double middle = 0.5 * (low + high);
    if (std::abs(x - middle) <= 2.0 * tolerance - 0.5 * (high - low)) break;
    // The vertex of the parabola through the three.
    const double r = (x - w) * (at_x - at_v), q = (x - v) * (at_x - at_w);
    const double numerator = (x - v) * q - (x - w) * r, denominator = 2.0 * (q - r);
    const double vertex = denominator != 0.0 ? -numerator / denominator : high;
    const bool is_inside = x + vertex > low && x + vertex < high;
    const bool is_parabola =
        std::abs(before) > tolerance && is_inside && std::abs(vertex) < 0.5 * std::abs(before);
    before = is_parabola ? step : (x < middle ? high : low) - x;
    step = is_parabola ? vertex : kGolden * before;
    const bool is_near_end = x + step - low < tolerance || high - x - step < tolerance;
    if (is_parabola && is_near_end) step = std::copysign(tolerance, middle - x);
    const double u = std::abs(step) >= tolerance ? x + step : x + std::copysign(tolerance, step);
    const double at_u = cost(u);
    if (at_u <= at_x) {
      (u < x ? high : low) = x;
      v = std::exchange(w, std::exchange(x, u));
      at_v = std::exchange(at_w, std::exchange(at_x, at_u));
    } else {
      (u < x ? low : high) = u;
      if (at_u <= at_w || w == x) {
        v = std::exchange(w, u);
        at_v = std::exchange(at_w, at_u);
      } else if (at_u <= at_v || v == x || v == w) {
        v = u;
        at_v = at_u;
      }
    }
  }
  return {x, at_x};
}

double fitted_instant(const Rise& rise, double fallback) {
  if (rise.tool.size() < 2 * kMinRise) return fallback;
  const double shallowest = *std::min_element(rise.tool.begin(), rise.tool.end());
  if (!(rise.max_surface > shallowest)) return fallback;
  const auto surface_for = [&](double exponent) {
    return minimise([&](double surface) { return misfit(rise, surface, exponent); }, shallowest,
                    rise.max_surface, 1e-4 * (rise.max_surface - shallowest));
  };
  const double exponent =
      minimise([&](double n) { return surface_for(n).second; }, 1.0, kMaxTouchExponent, 5e-3).first;
  const double surface = surface_for(exponent).first;
  // The last crossing of the surface before the sure contact.
  for (std::size_t i = rise.tool.size(); i-- > 1;) {
    if (rise.tool[i - 1] > surface || rise.tool[i] <= surface) continue;
    const double share = (surface - rise.tool[i - 1]) / (rise.tool[i] - rise.tool[i - 1]);
    return rise.t[i - 1] + share * (rise.t[i] - rise.t[i - 1]);
  }
  return fallback;
}

/// The instant of touch, by a fit from free space to half of the peak, or to where the tool stops;
/// `step` is 1, or -1 for a separation read backwards.
double instant(const TouchSignals& signals, std::size_t limit, std::size_t detected,
               std::size_t peak, int step) {
  const auto next = [step](std::size_t i) { return step > 0 ? i + 1 : i - 1; };
  const auto previous = [step](std::size_t i) { return step > 0 ? i - 1 : i + 1; };
  const double sure = signals.t[detected];
  std::size_t first = detected;
  while (first != limit && std::abs(signals.t[first] - sure) < kFree) {
    if (!signals.tool[previous(first)].is_valid) break;
    first = previous(first);
  }
  Rise rise;
  rise.max_surface = signals.tool[detected].value;
  const double half = 0.5 * signals.smooth_force[peak].value;
  const auto mean_speed = [&](std::size_t i) {
    std::size_t from = i;
    while (from != first && std::abs(signals.t[i] - signals.t[from]) < kSpeedWindow)
      from = previous(from);
    return from == i ? 0.0
                     : std::abs((signals.tool[i].value - signals.tool[from].value) /
                                (signals.t[i] - signals.t[from]));
  };
  const double speed_at_touch = mean_speed(detected);
  std::size_t in_contact = 0;
  for (std::size_t i = first; i != peak; i = next(i)) {
    const bool is_sure = step > 0 ? i >= detected : i <= detected;
    const bool is_over =
        signals.smooth_force[i].value > half || mean_speed(i) < kStoppingShare * speed_at_touch;
    if (!signals.tool[i].is_valid || (is_sure && is_over)) break;
    in_contact += is_sure ? 1 : 0;
    rise.t.push_back(signals.t[i]);
    rise.tool.push_back(signals.tool[i].value);
    rise.force.push_back(signals.force[i]);
  }
  return in_contact < kMinRise ? sure : fitted_instant(rise, sure);
}

}  // namespace

double touch_instant(const TouchSignals& signals, std::size_t earliest, std::size_t detected,
                     std::size_t peak) {
  return instant(signals, earliest, detected, peak, 1);
}

double separation_instant(const TouchSignals& signals, std::size_t peak, std::size_t detected,
                          std::size_t latest) {
  return instant(signals, latest, detected, peak, -1);
}

}  // namespace pcavr
