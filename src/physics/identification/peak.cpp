// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/peak.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "physics/identification/small_solve.hpp"

namespace pcavr {
namespace {

// Stds of the difference of two smoothed values: below, they count as equal.
constexpr double kEqualStds = 3.0;
constexpr double kWidening = 1.4;  // twice the samples in two steps
constexpr int kWidenings = 6;      // to about 45 ms
// Limits in stds: of chi squared, above which the parabola does not fit; and of a narrower window's
// peak, beyond which a wider one does not agree. They are a trade-off between the noise of narrow
// windows and the bias of wide ones; chosen on 124 simulated plants, validated on others (see the
// tests).
constexpr double kMaxMisfit = 1.0;
constexpr double kMaxDifference = 1.5;

struct Parabola {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  ///< over u = (t - t_about) / half_width
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  double sum = 0.0;  ///< of squared residuals
  double samples = 0.0;
};

std::optional<Parabola> parabola_over(const PeakSignals& signals, std::size_t about,
                                      double half_width) {
  Parabola fit;
  Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  double energy = 0.0;
  const double offset = signals.force[about];
  const double from = signals.t[about] - half_width * (1.0 + 1e-9);
  const auto begin = std::lower_bound(signals.t.begin(), signals.t.end(), from);
  for (auto i = static_cast<std::size_t>(begin - signals.t.begin()); i < signals.t.size(); ++i) {
    const double u = (signals.t[i] - signals.t[about]) / half_width;
    if (u > 1.0 + 1e-9) break;
    const Eigen::Vector3d row(1.0, u, u * u);
    fit.normal.noalias() += row * row.transpose();
    rhs += (signals.force[i] - offset) * row;
    energy += (signals.force[i] - offset) * (signals.force[i] - offset);
    fit.samples += 1.0;
  }
  if (fit.samples < 5.0) return {};
  fit.coefficients = solve_positive<3>(fit.normal, rhs);
  fit.sum = energy - fit.coefficients.dot(rhs);
  fit.coefficients[0] += offset;
  return fit;
}

}  // namespace

std::size_t first_peak(const PeakSignals& signals, std::size_t begin, std::size_t highest) {
  const auto& force = signals.smooth_force;
  const double about_equal =
      force[highest].value - kEqualStds * std::sqrt(2.0) * signals.smooth_noise;
  std::size_t peak = begin;
  while (peak < highest && force[peak].value < about_equal) ++peak;
  // Goes on upwards from there, over dips no longer than two windows of the smoothing.
  for (std::size_t i = peak; i <= highest; ++i) {
    if (signals.t[i] - signals.t[peak] > 4.0 * signals.half_width) break;
    if (force[i].value > force[peak].value) peak = i;
  }
  return peak;
}

ForcePeak fit_peak(const PeakSignals& signals, std::size_t about) {
  ForcePeak peak{signals.t[about], signals.smooth_force[about].value, signals.smooth_noise};
  // The range in which narrower windows agree.
  double highest = std::numeric_limits<double>::infinity();
  double lowest = -highest;
  double half_width = signals.half_width;
  for (int i = 0; i < kWidenings; ++i, half_width *= kWidening) {
    const std::optional<Parabola> fit = parabola_over(signals, about, half_width);
    if (!fit) continue;
    const double freedom = fit->samples - 3.0;
    const double max_sum = freedom + kMaxMisfit * std::sqrt(2.0 * freedom);
    if (fit->sum > max_sum * signals.noise * signals.noise) break;
    const Eigen::Vector3d& c = fit->coefficients;
    const double u_peak = c[2] < 0.0 ? std::clamp(-0.5 * c[1] / c[2], -1.0, 1.0) : 0.0;
    const Eigen::Vector3d row(1.0, u_peak, u_peak * u_peak);
    const double force = c.dot(row);
    if (force < lowest || force > highest) break;
    peak.t = signals.t[about] + u_peak * half_width;
    peak.force = force;
    peak.std = signals.noise * std::sqrt(row.dot(solve_positive<3>(fit->normal, row)));
    lowest = std::max(lowest, force - kMaxDifference * peak.std);
    highest = std::min(highest, force + kMaxDifference * peak.std);
  }
  return peak;
}

}  // namespace pcavr
