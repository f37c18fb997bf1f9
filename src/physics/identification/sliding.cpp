// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/sliding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/smoothed_values.hpp"

#include "physics/identification/derivative_noise.hpp"

namespace pcavr {
namespace {

// Fewer independent samples do not determine three parameters.
constexpr double kMinIndependent = 5.0;
// Ratio of a regressor's rms to its noise above which removing it biases more than keeping it.
constexpr double kMassNoiseFactor = 3.0;

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

/// Collects the samples in which the object slides steadily in contact with the tool.
void collect(const ForceMotion& push, const HuntCrossley& contact_law,
             const SlidingOptions& options, SlidingSamples& result) {
  PCAVR_REQUIRE(push.t.size() == push.tool.size() && push.t.size() == push.force.size());
  const std::size_t count = push.t.size();
  if (count < 20) return;
  const double interval = mean_interval(push.t);
  const double half_width = std::max(options.half_width, 3.0 * interval);
  result.correlated = std::max(result.correlated, correlated_samples(half_width, interval));
  const std::vector<double> force = remove_spikes(push.force).values;
  std::vector<double> object = penetration_from_force(push.t, force, contact_law);
  for (std::size_t i = 0; i < count; ++i) object[i] = push.tool[i] - object[i];
  const double noise =
      derivative_noise(estimate_noise_std(object), half_width, interval).acceleration;
  result.acceleration_noise = std::max(result.acceleration_noise, noise);
  const std::vector<SmoothedSample> x = smooth(push.t, object, push.t, half_width);
  const std::vector<SmoothedSample> f = smooth_values(push.t, force, push.t, half_width);
  std::vector<bool> is_sliding(count);
  for (std::size_t i = 0; i < count; ++i) {
    is_sliding[i] = x[i].is_valid && f[i].is_valid && x[i].rate > options.min_speed &&
                    f[i].value > options.min_force;
  }
  // A window over a stop contains a force that is not sliding friction: `begin` is the first sample
  // of the present slide, `end` the one after its last.
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

/// The columns of [a 1 v] that are fitted.
struct Model {
  bool has_mass = true;
  bool has_viscous = true;
};

ParameterEstimate<3> fit(const SlidingSamples& all, Model model, const SlidingOptions& options,
                         SlidingIdentification& result) {
  EstimatorOptions<3> estimator_options;
  estimator_options.min_forgetting = options.min_forgetting;
  estimator_options.error_window = options.error_window;
  estimator_options.scale = {0.5, 1.0, 0.05};  // of a modulated push: m/s^2, 1, m/s
  estimator_options.min_excitation = {options.min_acceleration, 0.0, options.min_speed_change};
  estimator_options.correlated_samples = all.correlated;
  ParameterEstimator<3> estimator(estimator_options);
  const double known_mass = options.mass.value_or(0.0);
  result.history.clear();
  double errors = 0.0, forces = 0.0;
  // 50 points a second are enough for a plot; each costs an estimate of its stds.
  std::optional<double> last_plotted;
  for (const SlidingSample& sample : all.samples) {
    const double inertial_force = model.has_mass ? 0.0 : known_mass * sample.acceleration;
    const EstimatorStep step = estimator.step(
        {model.has_mass ? sample.acceleration : 0.0, 1.0, model.has_viscous ? sample.speed : 0.0},
        sample.force - inertial_force);
    if (last_plotted && sample.t < *last_plotted + 0.02 && sample.t > *last_plotted) continue;
    last_plotted = sample.t;
    const ParameterEstimate<3> now = estimator.estimate();
    SlidingHistory& point = result.history.emplace_back();
    point.t = sample.t;
    std::copy(now.value.begin(), now.value.end(), point.value);
    std::copy(now.std.begin(), now.std.end(), point.std);
    point.measured = sample.force;
    point.estimated = step.prediction + inertial_force;
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

void set_coefficient(const SlidingOptions& options, SlidingIdentification& result) {
  const bool is_identified = result.mass.is_excited;
  if (!is_identified && !options.mass) return;
  const double mass = is_identified ? result.mass.value : *options.mass;
  const double mass_share = is_identified ? result.mass.std / mass : 0.0;
  const double force_share = result.coulomb.std / result.coulomb.value;
  result.coefficient.value = result.coulomb.value / (mass * options.gravity);
  result.coefficient.std = result.coefficient.value * std::hypot(mass_share, force_share);
  result.coefficient.is_excited = result.coulomb.is_excited;
}

void propose(SlidingIdentification& result) {
  if (!result.is_valid) {
    result.proposal = "keep pushing for a second or more at 40 mm/s: no steady sliding was found";
  } else if (!result.mass.is_excited || !result.viscous.is_excited) {
    result.proposal = "modulate the push at 2 Hz, 3 mm, on 60 mm/s, without stopping: ";
    result.proposal += result.mass.is_excited ? "viscous friction was" : "the mass was";
    result.proposal += " not excited";
  }
}

}  // namespace

std::vector<double> penetration_from_force(std::span<const double> t, std::span<const double> force,
                                           const HuntCrossley& contact_law) {
  PCAVR_REQUIRE(t.size() == force.size(), t.size(), force.size());
  PCAVR_REQUIRE(contact_law.stiffness > 0.0 && contact_law.exponent >= 1.0 &&
                contact_law.damping >= 0.0);
  const double n = contact_law.exponent;
  std::vector<double> depth(t.size(), 0.0);
  double before = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (force[i] <= 0.0) {
      before = 0.0;
      continue;
    }
    // The first sample has no predecessor: it is assumed to be at rest.
    const double per_step = i == 0 ? 0.0 : contact_law.damping / (t[i] - t[i - 1]);
    // g(d) = k d^n + c d^p (d - before) - F, p = n, or 0 where n is 1; from above, Newton's method
    // on an increasing, convex g converges to its root without overshooting.
    const double p = n == 1.0 ? 0.0 : n;
    double d = std::max(static_penetration(contact_law, force[i]), before);
    for (int iteration = 0; iteration < 20; ++iteration) {
      const double power = penetration_power(d, n);
      const double drag = per_step * (p == 0.0 ? 1.0 : power);
      const double value = contact_law.stiffness * power + drag * (d - before) - force[i];
      const double slope = contact_law.stiffness * n * power / d + drag +
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
                                       const HuntCrossley& contact_law,
                                       const SlidingOptions& options) {
  PCAVR_REQUIRE(options.half_width > 0.0 && options.gravity > 0.0);
  SlidingIdentification result;
  SlidingSamples all;
  for (const ForceMotion& push : pushes) collect(push, contact_law, options, all);
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
  const bool is_mass_identified =
      estimate.is_excited[0] && estimate.std[0] < options.max_mass_share * estimate.value[0];
  // Between noise and excitation the acceleration explains some force, though not precisely enough
  // for a mass.
  if (!is_mass_identified && result.acceleration < kMassNoiseFactor * all.acceleration_noise) {
    model.has_mass = false;
    estimate = fit(all, model, options, result);
  }
  if (!estimate.is_excited[2] ||
      estimate.std[2] > options.max_viscous_share * std::abs(estimate.value[2])) {
    model.has_viscous = false;
    estimate = fit(all, model, options, result);
  }
  if (model.has_mass) result.mass = {estimate.value[0], estimate.std[0], is_mass_identified};
  if (model.has_viscous) result.viscous = {estimate.value[2], estimate.std[2], true};
  result.coulomb = {estimate.value[1], estimate.std[1], estimate.is_excited[1]};
  set_coefficient(options, result);
  propose(result);
  return result;
}

}  // namespace pcavr
