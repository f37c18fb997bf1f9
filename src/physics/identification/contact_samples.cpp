// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/identification/contact_samples.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "physics/identification/derivative_noise.hpp"

namespace pcavr {
namespace {

/// The longest interval above `threshold`, as [begin, end).
std::pair<std::size_t, std::size_t> longest_contact(const std::vector<SmoothedSample>& force,
                                                    double threshold) {
  std::pair<std::size_t, std::size_t> best{0, 0};
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= force.size(); ++i) {
    const bool is_touching = i < force.size() && force[i].is_valid && force[i].value > threshold;
    if (is_touching) continue;
    if (i - begin > best.second - best.first) best = {begin, i};
    begin = i + 1;
  }
  return best;
}

/// Subtracts each signal's own moving mean over a longer window (detrending).
void subtract(const std::vector<SmoothedSample>& slow, std::vector<SmoothedSample>& samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].value -= slow[i].value;
    samples[i].rate -= slow[i].rate;
    samples[i].acceleration -= slow[i].acceleration;
    samples[i].is_valid = samples[i].is_valid && slow[i].is_valid;
  }
}

}  // namespace

ContactSample mean_of(std::span<const ContactSample> samples) {
  ContactSample mean;
  const double weight = 1.0 / static_cast<double>(samples.size());
  for (const ContactSample& sample : samples) {
    mean.position += weight * sample.position;
    mean.speed += weight * sample.speed;
    mean.acceleration += weight * sample.acceleration;
    mean.force += weight * sample.force;
  }
  return mean;
}

PressSamples press_samples(const ForceMotion& press, const ContactFitOptions& options) {
  PCAVR_REQUIRE(press.t.size() == press.tool.size() && press.t.size() == press.force.size());
  PCAVR_REQUIRE(options.half_width > 0.0, options.half_width);
  PressSamples result;
  const std::size_t count = press.t.size();
  if (count < 20) return result;
  result.interval = mean_interval(press.t);
  result.half_width = std::max(options.half_width, 3.0 * result.interval);
  const std::vector<double> force = remove_spikes(press.force).values;
  std::vector<SmoothedSample> x = smooth(press.t, press.tool, press.t, result.half_width);
  std::vector<SmoothedSample> f = smooth(press.t, force, press.t, result.half_width);
  result.position_noise = press.tool_noise ? *press.tool_noise : estimate_noise_std(press.tool);
  result.force_noise = estimate_noise_std(force);
  const DerivativeNoise noise =
      derivative_noise(result.position_noise, result.half_width, result.interval);
  result.speed_noise = noise.rate;
  result.acceleration_noise = noise.acceleration;

  const double force_noise =
      result.force_noise / std::sqrt(correlated_samples(result.half_width, result.interval));
  auto [begin, end] = longest_contact(f, options.contact_threshold * force_noise);
  if (end > begin) result.onset = x[begin].value;
  const auto margin = static_cast<std::size_t>(std::ceil(result.half_width / result.interval));
  // The raw samples begin before the threshold: those above it alone have a positive error on the
  // average, which moves the surface outwards and increases the exponent.
  const std::size_t last = end > begin ? std::min(end + margin, count) : end;
  for (std::size_t i = begin - std::min(begin, margin); i < last; ++i) {
    result.raw.push_back({press.tool[i], x[i].rate, x[i].acceleration, force[i]});
  }
  if (options.drift_half_width > 0.0) {
    subtract(smooth(press.t, press.tool, press.t, options.drift_half_width), x);
    subtract(smooth(press.t, force, press.t, options.drift_half_width), f);
  }
  // The window must not include the impact or the separation: the law is not smooth there.
  for (std::size_t i = begin + margin; i + margin < end; ++i) {
    if (!x[i].is_valid || !f[i].is_valid) continue;
    result.samples.push_back({x[i].value, x[i].rate, x[i].acceleration, f[i].value});
  }
  return result;
}

}  // namespace pcavr
