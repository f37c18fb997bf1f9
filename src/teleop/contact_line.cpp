// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/contact_line.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr std::size_t kMinSamples = 20;
constexpr double kSlopeKnown = 0.1;
// A chord of nothing would hold any force [m/N].
constexpr double kStiffest = 1e-7;

}  // namespace

void ContactLine::add(double tip, double force, double correlated) {
  if (count_++ == 0) origin_ = tip;
  if (force > 2.0 * touch_force_) {
    chord_ = std::max((tip - touch_) / (force - touch_force_), kStiffest);
  }
  const double x = tip - origin_;
  x_ += x;
  xx_ += x * x;
  for (std::size_t law = 0; law < kExponents.size(); ++law) {
    const double g = std::pow(force, 1.0 / kExponents[law]);
    sums_[law].g += g;
    sums_[law].gg += g * g;
    sums_[law].gx += g * x;
  }
  if (is_ready_ || count_ < kMinSamples) return;
  const Fit line = fit(best());
  is_ready_ =
      line.slope > 0.0 && line.slope_deviation * std::sqrt(correlated) < kSlopeKnown * line.slope;
}

ContactLine::Fit ContactLine::fit(std::size_t law) const {
  const auto n = static_cast<double>(count_);
  const Sums& s = sums_[law];
  const double spread = s.gg - s.g * s.g / n;
  const double both = s.gx - s.g * x_ / n;
  Fit result;
  if (spread > 0.0) result.slope = std::max(both / spread, 0.0);
  result.surface = (x_ - result.slope * s.g) / n;
  result.residual =
      xx_ - x_ * x_ / n - 2.0 * result.slope * both + result.slope * result.slope * spread;
  if (spread > 0.0 && n > 2.0) {
    result.slope_deviation = std::sqrt(std::max(result.residual, 0.0) / (n - 2.0) / spread);
  }
  return result;
}

std::size_t ContactLine::best() const { return fit(1).residual < fit(0).residual ? 1 : 0; }

double ContactLine::surface() const { return is_ready_ ? origin_ + fit(best()).surface : touch_; }

double ContactLine::depth(double force) const {
  if (!is_ready_) return chord_ * std::max(force - touch_force_, 0.0);
  const std::size_t law = best();
  return fit(law).slope * std::pow(std::max(force, 0.0), 1.0 / kExponents[law]);
}

double ContactLine::force(double depth) const {
  if (!is_ready_) return touch_force_ + std::max(depth, 0.0) / chord_;
  const std::size_t law = best();
  return std::pow(std::max(depth, 0.0) / fit(law).slope, kExponents[law]);
}

}  // namespace pcavr
