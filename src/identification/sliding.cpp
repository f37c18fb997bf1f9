// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/identification/sliding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "pcavr/core/check.hpp"
#include "pcavr/identification/estimator.hpp"
#include "pcavr/identification/signals.hpp"

#include "identification/derivative_noise.hpp"

namespace pcavr {
namespace {

// Fewer independent samples than this tell nothing about three parameters.
constexpr double kMinIndependent = 5.0;
// A regressor's rms over its noise's from which leaving it out does more harm than keeping it.
constexpr double kMassNoiseFactor = 3.0;
// Deviations, as shares of the value, up to which a mass and a viscous friction count as told.
constexpr double kMassTold = 0.1;
constexpr double kViscousTold = 0.3;

struct SlidingSample {
  double t = 0.0;
  double speed = 0.0;
  double acceleration = 0.0;
  double force = 0.0;
};

struct SlidingSamples {
  std::vector<SlidingSample> samples;
  double correlated = 1.0;
  double acceleration_noise = 0.0;  ///< [m/s^2] of the smoothed acceleration
};

/// Where the object slides steadily with the tool against it.
void collect(const ForceMotion& push, const Compliance& compliance, const SlidingOptions& options,
             SlidingSamples& result) {
  PCAVR_REQUIRE(push.t.size() == push.tool.size() && push.t.size() == push.force.size());
  const std::size_t count = push.t.size();
  if (count < 20) return;
  const double interval = mean_interval(push.t);
  const double half_width = std::max(options.half_width, 3.0 * interval);
  result.correlated = std::max(result.correlated, correlated_samples(half_width, interval));
  const std::vector<double> force = remove_spikes(push.force).values;
  std::vector<double> object = deformation(push.t, force, compliance);
  for (std::size_t i = 0; i < count; ++i) object[i] = push.tool[i] - object[i];
  const double noise = derivative_noise(noise_deviation(object), half_width, interval).acceleration;
  result.acceleration_noise = std::max(result.acceleration_noise, noise);
  const std::vector<SmoothedSample> x = smooth(push.t, object, push.t, half_width);
  const std::vector<SmoothedSample> f = smooth(push.t, force, push.t, half_width);
  std::vector<bool> is_sliding(count);
  for (std::size_t i = 0; i < count; ++i) {
    is_sliding[i] = x[i].is_valid && f[i].is_valid && x[i].rate > options.min_speed &&
                    f[i].value > options.min_force;
  }
  // A window that reaches over a stop holds a force that is not sliding friction: `begin` is the
  // first instant of the present slide, `end` the one after its last.
  for (std::size_t begin = 0, end; begin < count; begin = end + 1) {
    end = begin;
    while (end < count && is_sliding[end]) ++end;
    for (std::size_t i = begin; i < end; ++i) {
      if (push.t[i] < push.t[begin] + options.settle + half_width) continue;
      if (push.t[i] > push.t[end - 1] - half_width) continue;
      result.samples.push_back({push.t[i], x[i].rate, x[i].acceleration, f[i].value});
    }
  }
}

/// Which columns of [a 1 v] take part.
struct Model {
  bool has_mass = true;
  bool has_viscous = true;
};

ParameterEstimate<3> fit(const SlidingSamples& all, Model model, const SlidingOptions& options,
                         SlidingIdentification& result) {
  EstimatorOptions<3> estimator_options;
  estimator_options.scale = {0.5, 1.0, 0.05};
  estimator_options.min_excitation = {options.min_acceleration, 0.0, options.min_speed_change};
  estimator_options.correlated_samples = all.correlated;
  ParameterEstimator<3> estimator(estimator_options);
  const double known_mass = options.mass.value_or(0.0);
  result.history.clear();
  double errors = 0.0, forces = 0.0;
  // A curve needs no more points than this; each costs its deviations.
  std::optional<double> drawn;
  for (const SlidingSample& sample : all.samples) {
    const double carried = model.has_mass ? 0.0 : known_mass * sample.acceleration;
    const EstimatorStep step = estimator.step(
        {model.has_mass ? sample.acceleration : 0.0, 1.0, model.has_viscous ? sample.speed : 0.0},
        sample.force - carried);
    if (drawn && sample.t < *drawn + 0.02 && sample.t > *drawn) continue;
    drawn = sample.t;
    const ParameterEstimate<3> now = estimator.estimate();
    SlidingHistory& point = result.history.emplace_back();
    point.t = sample.t;
    std::copy(now.value.begin(), now.value.end(), point.value);
    std::copy(now.deviation.begin(), now.deviation.end(), point.deviation);
    point.measured = sample.force;
    point.estimated = step.prediction + carried;
  }
  const ParameterEstimate<3> estimate = estimator.estimate();
  for (const SlidingSample& sample : all.samples) {
    const double mass = model.has_mass ? estimate.value[0] : known_mass;
    const double viscous = model.has_viscous ? estimate.value[2] : 0.0;
    const double modelled = mass * sample.acceleration + estimate.value[1] + viscous * sample.speed;
    errors += std::pow(sample.force - modelled, 2);
    forces += sample.force * sample.force;
  }
  result.residual = std::sqrt(errors / static_cast<double>(all.samples.size()));
  result.relative_error = std::sqrt(errors / forces);
  return estimate;
}

void state_coefficient(const SlidingOptions& options, SlidingIdentification& result) {
  const bool is_identified = result.mass.is_excited;
  if (!is_identified && !options.mass) return;
  const double mass = is_identified ? result.mass.value : *options.mass;
  const double mass_share = is_identified ? result.mass.deviation / mass : 0.0;
  const double force_share = result.coulomb.deviation / result.coulomb.value;
  result.coefficient.value = result.coulomb.value / (mass * options.gravity);
  result.coefficient.deviation = result.coefficient.value * std::hypot(mass_share, force_share);
  result.coefficient.is_excited = result.coulomb.is_excited;
}

void propose(SlidingIdentification& result) {
  if (!result.is_valid) {
    result.proposal = "push on for a second or more at 40 mm/s: no steady sliding was seen";
  } else if (!result.mass.is_excited || !result.viscous.is_excited) {
    result.proposal = "modulate the push at 2 Hz, 3 mm, on 60 mm/s, without stopping: ";
    result.proposal += result.mass.is_excited ? "viscous friction was" : "the mass was";
    result.proposal += " not excited";
  }
}

}  // namespace

std::vector<double> deformation(std::span<const double> t, std::span<const double> force,
                                const Compliance& compliance) {
  PCAVR_REQUIRE(t.size() == force.size(), t.size(), force.size());
  PCAVR_REQUIRE(compliance.stiffness > 0.0 && compliance.exponent >= 1.0 &&
                compliance.damping >= 0.0);
  const double n = compliance.exponent;
  std::vector<double> depth(t.size(), 0.0);
  double before = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (force[i] <= 0.0) {
      before = 0.0;
      continue;
    }
    // The first sample has no past: it is held to be at rest.
    const double per_step = i == 0 ? 0.0 : compliance.damping / (t[i] - t[i - 1]);
    // g(d) = k d^n + c d^p (d - before) - F, p = n, or 0 where n is 1; from above, Newton's steps
    // on a growing, convex g fall to its root without overshooting.
    const double p = n == 1.0 ? 0.0 : n;
    double d = std::max(std::pow(force[i] / compliance.stiffness, 1.0 / n), before);
    for (int iteration = 0; iteration < 20; ++iteration) {
      const double power = std::pow(d, n);
      const double drag = per_step * (p == 0.0 ? 1.0 : power);
      const double value = compliance.stiffness * power + drag * (d - before) - force[i];
      const double slope = compliance.stiffness * n * power / d + drag +
                           (p == 0.0 ? 0.0 : per_step * n * power / d * (d - before));
      const double next = std::max(d - value / slope, 0.1 * d);
      if (std::abs(next - d) < 1e-12) break;
      d = next;
    }
    depth[i] = d;
    before = d;
  }
  return depth;
}

SlidingIdentification identify_sliding(std::span<const ForceMotion> pushes,
                                       const Compliance& compliance,
                                       const SlidingOptions& options) {
  PCAVR_REQUIRE(options.half_width > 0.0 && options.gravity > 0.0);
  SlidingIdentification result;
  SlidingSamples all;
  for (const ForceMotion& push : pushes) collect(push, compliance, options, all);
  result.samples = all.samples.size();
  result.is_valid = static_cast<double>(all.samples.size()) >= kMinIndependent * all.correlated;
  if (!result.is_valid) {
    propose(result);
    return result;
  }
  for (const SlidingSample& sample : all.samples) {
    result.speed += sample.speed / static_cast<double>(all.samples.size());
    result.acceleration += sample.acceleration * sample.acceleration;
  }
  result.acceleration = std::sqrt(result.acceleration / static_cast<double>(all.samples.size()));

  Model model;
  ParameterEstimate<3> estimate = fit(all, model, options, result);
  const bool is_mass_told =
      estimate.is_excited[0] && estimate.deviation[0] < kMassTold * estimate.value[0];
  // Between noise and excitation the acceleration explains some force, if not precisely enough to
  // call it a mass.
  if (!is_mass_told && result.acceleration < kMassNoiseFactor * all.acceleration_noise) {
    model.has_mass = false;
    estimate = fit(all, model, options, result);
  }
  if (!estimate.is_excited[2] ||
      estimate.deviation[2] > kViscousTold * std::abs(estimate.value[2])) {
    model.has_viscous = false;
    estimate = fit(all, model, options, result);
  }
  if (model.has_mass) result.mass = {estimate.value[0], estimate.deviation[0], is_mass_told};
  if (model.has_viscous) result.viscous = {estimate.value[2], estimate.deviation[2], true};
  result.coulomb = {estimate.value[1], estimate.deviation[1], estimate.is_excited[1]};
  state_coefficient(options, result);
  propose(result);
  return result;
}

}  // namespace pcavr
