// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identification/peak.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "identification/small_solve.hpp"

namespace pcavr {
namespace {

// Of the difference of two smoothed values: below, they count as equal.
constexpr double kEqualDeviations = 3.0;
constexpr double kWidening = 1.4;
constexpr int kWidenings = 6;  // to some 45 ms
// In deviations, of chi squared: residuals above do not fit; and of a narrower window's peak: a
// peak farther off is another one. Both weigh the noise of narrow windows against the asymmetry
// that wide ones blur; chosen on 124 simulated plants, judged on others (see the tests).
constexpr double kMisfit = 1.0;
constexpr double kAgrees = 1.5;

struct Parabola {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  ///< over u = (t - t_about) / half_width
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  double sum = 0.0;  ///< of squared residuals
  double samples = 0.0;
};

std::optional<Parabola> parabola_over(const PeakSignals& signals, std::size_t about,
                                      double half_width) {
  Parabola fit;
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();
  double energy = 0.0;
  const double offset = signals.force[about];
  const double from = signals.t[about] - half_width * (1.0 + 1e-9);
  const auto begin = std::lower_bound(signals.t.begin(), signals.t.end(), from);
  for (auto i = static_cast<std::size_t>(begin - signals.t.begin()); i < signals.t.size(); ++i) {
    const double u = (signals.t[i] - signals.t[about]) / half_width;
    if (u > 1.0 + 1e-9) break;
    const Eigen::Vector3d row(1.0, u, u * u);
    fit.normal.noalias() += row * row.transpose();
    pull += (signals.force[i] - offset) * row;
    energy += (signals.force[i] - offset) * (signals.force[i] - offset);
    fit.samples += 1.0;
  }
  if (fit.samples < 5.0) return {};
  fit.coefficients = solve_positive<3>(fit.normal, pull);
  fit.sum = energy - fit.coefficients.dot(pull);
  fit.coefficients[0] += offset;
  return fit;
}

}  // namespace

std::size_t first_peak(const PeakSignals& signals, std::size_t begin, std::size_t highest) {
  const auto& soft = signals.soft_force;
  const double about_equal =
      soft[highest].value - kEqualDeviations * std::sqrt(2.0) * signals.soft_noise;
  std::size_t peak = begin;
  while (peak < highest && soft[peak].value < about_equal) ++peak;
  // From there up, over bumps no longer than two windows of the smoothing.
  for (std::size_t i = peak; i <= highest; ++i) {
    if (signals.t[i] - signals.t[peak] > 4.0 * signals.half_width) break;
    if (soft[i].value > soft[peak].value) peak = i;
  }
  return peak;
}

ForcePeak fit_peak(const PeakSignals& signals, std::size_t about) {
  ForcePeak peak{signals.t[about], signals.soft_force[about].value, signals.soft_noise};
  // What narrower windows allow.
  double highest = std::numeric_limits<double>::infinity();
  double lowest = -highest;
  double half_width = signals.half_width;
  for (int i = 0; i < kWidenings; ++i, half_width *= kWidening) {
    const std::optional<Parabola> fit = parabola_over(signals, about, half_width);
    if (!fit) continue;
    const double freedom = fit->samples - 3.0;
    const double most = freedom + kMisfit * std::sqrt(2.0 * freedom);
    if (fit->sum > most * signals.noise * signals.noise) break;
    const Eigen::Vector3d& c = fit->coefficients;
    const double place = c[2] < 0.0 ? std::clamp(-0.5 * c[1] / c[2], -1.0, 1.0) : 0.0;
    const Eigen::Vector3d row(1.0, place, place * place);
    const double force = c.dot(row);
    if (force < lowest || force > highest) break;
    peak.t = signals.t[about] + place * half_width;
    peak.force = force;
    peak.deviation = signals.noise * std::sqrt(row.dot(solve_positive<3>(fit->normal, row)));
    lowest = std::max(lowest, force - kAgrees * peak.deviation);
    highest = std::min(highest, force + kAgrees * peak.deviation);
  }
  return peak;
}

}  // namespace pcavr
