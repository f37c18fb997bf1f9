// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/drifting_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "pcavr/physics/identification/limit_of_pushes.hpp"

#include "physics/identification/contact_samples.hpp"

namespace pcavr {
namespace {

constexpr double kMinExplained = 0.9;   // share of a window's force about its mean
constexpr std::size_t kMinWindows = 3;  // whose scatter is known
constexpr std::size_t kMinWindowSamples = 3;
/// Scatter of the stiffness of tissue from place to place.
constexpr double kWindowScatter = 0.05, kWindowScatterFactor = 2.0;
/// Error of the stiffness, as a share, by a direction that is not the surface's normal: along the
/// force, a tip that slides with a friction of 0.2 gives by 4 % more; along one direction, a
/// surface tilted by 15 degrees by 7 % less.
constexpr double kNormalShare = 0.05;
constexpr double kMinPositionNoises = 10.0;  // smoothed, of the oscillation

/// The samples of a contact that is shorter than a window, about their mean. A tip that is lifted
/// between presses while it travels meets another place of the surface each time.
std::vector<ContactSample> about_mean(std::vector<ContactSample> samples) {
  const ContactSample mean = mean_of(samples);
  for (ContactSample& sample : samples) {
    sample.position -= mean.position;
    sample.speed -= mean.speed;
    sample.force -= mean.force;
  }
  return samples;
}

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
  const double independent = std::max(3.0, count * press.interval / (2.0 * press.half_width));
  const double variance = std::max(0.0, ff - k * xf - b * vf) / count;
  fit.stiffness = {k, std::sqrt(variance * vv / determinant * count / independent),
                   fit.explained > kMinExplained && k > 0.0};
  return fit;
}

}  // namespace

bool is_short_press(const ForceMotion& press, const ContactFitOptions& options) {
  return press.t.empty() || press.t.back() - press.t.front() < options.moving_window;
}

ContactFit fit_drifting_surface(std::span<const ForceMotion> presses,
                                const ContactFitOptions& options) {
  ContactFit result;
  ContactFitOptions drifting = options;
  drifting.drift_half_width = options.moving_half_width;
  std::vector<IdentifiedParameter> windows;
  double unexplained = 0.0, count = 0.0, energy = 0.0;
  for (const ForceMotion& series : presses) {
    const bool is_short = is_short_press(series, options);
    PressSamples press = press_samples(series, is_short ? options : drifting);
    if (press.samples.size() < kMinWindowSamples) continue;
    auto length = std::max(kMinWindowSamples,
                           static_cast<std::size_t>(options.moving_window / press.interval));
    if (is_short) {
      press.samples = about_mean(std::move(press.samples));
      length = press.samples.size();
    }
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
  result.relative_error = result.residual / std::sqrt(energy / static_cast<double>(result.samples));
  result.stiffness = combine_limits(windows, kWindowScatter, kWindowScatterFactor).limit;
  result.stiffness.std = std::hypot(result.stiffness.std, kNormalShare * result.stiffness.value);
  result.exponent = {1.0, options.prior_exponent_std, true};
  result.penetration_std = result.stiffness.std / result.stiffness.value;
  result.is_valid = result.stiffness.is_excited;
  return result;
}

}  // namespace pcavr
