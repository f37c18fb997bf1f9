// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/contact_line.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {
namespace {

// Fewer samples are fitted too well by chance: their slope's standard error is too small.
constexpr std::size_t kMinSamples = 20;
// Relative standard error of the slope above which the chord errs less than the line.
constexpr double kMaxSlopeError = 0.1;
// A chord of zero compliance would be infinitely stiff [m/N].
constexpr double kMinCompliance = 1e-7;

}  // namespace

void ContactLine::add(double tip, double force, double correlated) {
  if (count_++ == 0) origin_ = tip;
  if (force > 2.0 * touch_force_) {
    chord_ = std::max((tip - touch_) / (force - touch_force_), kMinCompliance);
  }
  const double x = tip - origin_;
  x_ += x;
  xx_ += x * x;
  for (std::size_t law = 0; law < kExponents.size(); ++law) {
    const double g = static_penetration({.stiffness = 1.0, .exponent = kExponents[law]}, force);
    sums_[law].g += g;
    sums_[law].gg += g * g;
    sums_[law].gx += g * x;
  }
  if (is_ready_ || count_ < kMinSamples) return;
  const Fit line = fit(best());
  is_ready_ =
      line.slope > 0.0 && line.slope_std * std::sqrt(correlated) < kMaxSlopeError * line.slope;
}

ContactLine::Fit ContactLine::fit(std::size_t law) const {
  const auto n = static_cast<double>(count_);
  const Sums& s = sums_[law];
  const double variance_sum = s.gg - s.g * s.g / n;
  const double covariance_sum = s.gx - s.g * x_ / n;
  Fit result;
  if (variance_sum > 0.0) result.slope = std::max(covariance_sum / variance_sum, 0.0);
  result.surface = (x_ - result.slope * s.g) / n;
  result.residual = xx_ - x_ * x_ / n - 2.0 * result.slope * covariance_sum +
                    result.slope * result.slope * variance_sum;
  if (variance_sum > 0.0 && n > 2.0) {
    result.slope_std = std::sqrt(std::max(result.residual, 0.0) / (n - 2.0) / variance_sum);
  }
  return result;
}

std::size_t ContactLine::best() const { return fit(1).residual < fit(0).residual ? 1 : 0; }

double ContactLine::surface() const { return is_ready_ ? origin_ + fit(best()).surface : touch_; }

double ContactLine::penetration(double force) const {
  if (!is_ready_) return chord_ * std::max(force - touch_force_, 0.0);
  const std::size_t law = best();
  return fit(law).slope *
         static_penetration({.stiffness = 1.0, .exponent = kExponents[law]}, force);
}

double ContactLine::force(double penetration) const {
  if (!is_ready_) return touch_force_ + std::max(penetration, 0.0) / chord_;
  const std::size_t law = best();
  return penetration_power(penetration / fit(law).slope, kExponents[law]);
}

}  // namespace pcavr
