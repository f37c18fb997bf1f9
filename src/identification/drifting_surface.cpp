// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identification/drifting_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcavr/identification/limit_of_pushes.hpp"

#include "identification/contact_samples.hpp"

namespace pcavr {
namespace {

/// Half width of the moving mean [s]: it removes what is slower than 1 Hz.
constexpr double kDriftHalfWidth = 0.5;
constexpr double kDriftWindow = 2.0;  // [s] of one stiffness: some periods
/// A drift must leave a residual smaller by this factor: it has more freedom.
constexpr double kMinDriftGain = 2.0;
constexpr double kMinExplained = 0.9;   // share of a window's force about its mean
constexpr std::size_t kMinWindows = 3;  // whose scatter is known
constexpr double kWindowScatter = 0.05, kWindowScatterFactor = 2.0;  // of tissue, from place to place
/// Error of the stiffness, as a share, as the surface's normal changes under a travelling tip: tilted
/// by 15 degrees, it gives by 7 % less along the press's mean direction.
constexpr double kNormalShare = 0.05;
constexpr double kMinPositionNoises = 10.0;  // smoothed, of the oscillation

/// Least squares of one window, without a mass.
struct WindowFit {
  IdentifiedParameter stiffness;
  double explained = 0.0;  ///< share of the force's variance
};

WindowFit fit_window(std::span<const ContactSample> samples, const PressSamples& press) {
  double xx = 0.0, xv = 0.0, vv = 0.0, xf = 0.0, vf = 0.0, ff = 0.0;
  for (const ContactSample& s : samples) {
    xx += s.position * s.position, xv += s.position * s.speed, vv += s.speed * s.speed;
    xf += s.position * s.force, vf += s.speed * s.force, ff += s.force * s.force;
  }
  WindowFit fit;
  const double determinant = xx * vv - xv * xv;
  const double noise = kMinPositionNoises * press.position_noise;
  const double count = static_cast<double>(samples.size());
  if (!(determinant > 0.0) || !(ff > 0.0) || xx < count * noise * noise) return fit;
  const double k = (xf * vv - vf * xv) / determinant;
  const double b = (vf * xx - xf * xv) / determinant;
  fit.explained = (k * xf + b * vf) / ff;
  const double independent =
      std::max(3.0, count * press.interval / (2.0 * press.half_width));
  const double variance = std::max(0.0, ff - k * xf - b * vf) / count;
  fit.stiffness = {k, std::sqrt(variance * vv / determinant * count / independent),
                   fit.explained > kMinExplained && k > 0.0};
  return fit;
}

}  // namespace

ContactFit fit_drifting_surface(std::span<const ForceMotion> presses, const ContactFit& fixed,
                                const ContactFitOptions& options) {
  ContactFit result;
  ContactFitOptions drifting = options;
  drifting.drift_half_width = kDriftHalfWidth;
  std::vector<IdentifiedParameter> windows;
  double unexplained = 0.0, count = 0.0, energy = 0.0;
  for (const ForceMotion& series : presses) {
    const PressSamples press = press_samples(series, drifting);
    if (press.samples.empty()) continue;
    const auto length = static_cast<std::size_t>(kDriftWindow / press.interval);
    for (const ContactSample& sample : press.raw) energy += sample.force * sample.force;
    result.samples += press.raw.size();
    for (std::size_t i = 0; i + length <= press.samples.size(); i += length) {
      const std::span window = std::span(press.samples).subspan(i, length);
      const WindowFit fit = fit_window(window, press);
      for (const ContactSample& sample : window) {
        unexplained += (1.0 - fit.explained) * sample.force * sample.force;
        count += 1.0;
      }
      if (fit.stiffness.is_excited) windows.push_back(fit.stiffness);
    }
  }
  if (windows.size() < kMinWindows) return result;
  result.residual = std::sqrt(unexplained / count);
  result.relative_error =
      result.residual / std::sqrt(energy / static_cast<double>(result.samples));
  if (fixed.is_valid && fixed.residual < kMinDriftGain * result.residual) return result;
  result.surface = fixed.surface;
  result.stiffness = combine_limits(windows, kWindowScatter, kWindowScatterFactor).limit;
  result.stiffness.std = std::hypot(result.stiffness.std, kNormalShare * result.stiffness.value);
  result.exponent = {1.0, kExponentStd, true};
  result.penetration_std = result.stiffness.std / result.stiffness.value;
  result.is_valid = result.stiffness.is_excited;
  return result;
}

}  // namespace pcavr
