// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/contact_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "physics/identification/contact_samples.hpp"
#include "physics/identification/drifting_surface.hpp"

namespace pcavr {
namespace {

// A regressor made of noise alone has its noise's rms; three times that is motion.
constexpr double kNoiseFactor = 3.0;
// An exponent below is that of a linear law: in a tie, noise decides about the rest.
constexpr double kMaxLinearExponent = 1.15;
constexpr double kMinExponentStd = 0.01;  // no measured law is linear to more than that
// Largest noise, as a share of the accelerations' rms: beyond, it makes the mass smaller by its
// square and more, since at one frequency the mass hardly differs from a stiffness.
constexpr double kMaxNoiseShare = 0.05;
/// Ratio of the residual forces that is needed to assume another surface at each short press: with
/// two unknowns for each press, the fit gains some per cent even where one law holds.
constexpr double kMinShortGain = 1.25;
/// Smallest number of short presses: with fewer, another place of the surface looks the same as an
/// error of the law.
constexpr std::ptrdiff_t kMinShortPresses = 8;
constexpr double kMaxSmoothing = 4.0;   // times the half width of the options
constexpr double kSmoothingStep = 1.4;  // from one half width to the next

/// Typical magnitudes of acceleration, speed and position about each press's mean.
std::array<double, 3> scales_of(const std::vector<PressSamples>& presses) {
  std::array<double, 3> sum = {1e-18, 1e-18, 1e-18};  // a constant signal has no scale of its own
  double count = 1.0;
  for (const PressSamples& press : presses) {
    if (press.samples.empty()) continue;
    const ContactSample mean = mean_of(press.samples);
    for (const ContactSample& sample : press.samples) {
      sum[0] += std::pow(sample.acceleration - mean.acceleration, 2);
      sum[1] += std::pow(sample.speed - mean.speed, 2);
      sum[2] += std::pow(sample.position - mean.position, 2);
      count += 1.0;
    }
  }
  for (double& value : sum) value = std::sqrt(value / count);
  return sum;
}

EstimatorOptions<3> linear_options(const std::vector<PressSamples>& presses) {
  EstimatorOptions<3> options;
  options.method = EstimationMethod::exponential;
  options.forgetting = 1.0;
  options.prior_information = 1e-9;
  options.scale = scales_of(presses);
  const PressSamples& first = presses.front();
  options.correlated_samples = correlated_samples(first.half_width, first.interval);
  for (const PressSamples& press : presses) {
    options.min_excitation[0] =
        std::max(options.min_excitation[0], kNoiseFactor * press.acceleration_noise);
    options.min_excitation[1] =
        std::max(options.min_excitation[1], kNoiseFactor * press.speed_noise);
  }
  return options;
}

/// Least squares on the signals less each press's mean: the surface's coordinate cancels.
ParameterEstimate<3> regress(const std::vector<PressSamples>& presses, bool has_mass) {
  ParameterEstimator<3> estimator(linear_options(presses));
  for (const PressSamples& press : presses) {
    if (press.samples.empty()) continue;
    const ContactSample mean = mean_of(press.samples);
    for (const ContactSample& sample : press.samples) {
      estimator.step({has_mass ? sample.acceleration - mean.acceleration : 0.0,
                      sample.speed - mean.speed, sample.position - mean.position},
                     sample.force - mean.force);
    }
  }
  return estimator.estimate();
}

void set_parameters(const ParameterEstimate<3>& estimate, double exponent_std, ContactFit& fit) {
  fit.mass = {estimate.value[0], estimate.std[0], estimate.is_excited[0]};
  fit.damping = {estimate.value[1], estimate.std[1], estimate.is_excited[1]};
  fit.stiffness = {estimate.value[2], estimate.std[2], estimate.is_excited[2]};
  fit.exponent = {1.0, exponent_std, true};
}

ContactFit fit_linear(const std::vector<PressSamples>& presses, const ContactFitOptions& options) {
  ContactFit fit;
  double energy = 0.0;
  for (const PressSamples& press : presses) {
    fit.samples += press.samples.size();
    for (const ContactSample& sample : press.samples) energy += sample.force * sample.force;
  }
  if (fit.samples < 12 + presses.size() || energy <= 0.0) return fit;
  ParameterEstimate<3> estimate = regress(presses, true);
  set_parameters(estimate, options.prior_exponent_std, fit);
  // At one frequency the mass is confounded with the stiffness: x'' is -w^2 x. A mass that is not
  // significant would bias k, so it is removed from the model, as in sliding.
  fit.mass.is_excited =
      fit.mass.is_excited && fit.mass.value > options.min_mass_stds * fit.mass.std;
  if (!fit.mass.is_excited) {
    estimate = regress(presses, false);
    set_parameters(estimate, options.prior_exponent_std, fit);
    fit.mass = {};
  }
  const double samples = static_cast<double>(fit.samples);
  fit.residual = std::sqrt(estimate.residual_variance * (samples - 3.0) / samples);
  fit.relative_error = fit.residual / std::sqrt(energy / samples);
  fit.is_valid = fit.stiffness.is_excited && fit.stiffness.value > 0.0;
  if (fit.is_valid) fit.penetration_std = fit.stiffness.std / fit.stiffness.value;
  for (const PressSamples& press : presses) {
    if (press.samples.empty()) {
      fit.surface.push_back(press.onset);
      continue;
    }
    const ContactSample mean = mean_of(press.samples);
    const double lift =
        mean.force - fit.mass.value * mean.acceleration - fit.damping.value * mean.speed;
    fit.surface.push_back(mean.position - lift / fit.stiffness.value);
  }
  return fit;
}

std::vector<PressSamples> samples_of(std::span<const ForceMotion> presses,
                                     const std::vector<std::size_t>& touched,
                                     const ContactFitOptions& options) {
  std::vector<PressSamples> samples;
  samples.reserve(touched.size());
  for (const std::size_t i : touched) samples.push_back(press_samples(presses[i], options));
  return samples;
}

/// The linear law with its mass, if that is significant, of signals smoothed until noise is a small
/// share of the accelerations: the law holds of signals that any kernel has smoothed, and only the
/// ends of the presses are lost. `samples`: by the half width of `options`, which get the one used.
std::optional<ContactFit> fit_with_mass(std::span<const ForceMotion> presses,
                                        const std::vector<std::size_t>& touched,
                                        std::vector<PressSamples> samples,
                                        ContactFitOptions& options) {
  ContactFitOptions wider = options;
  for (; wider.half_width < kMaxSmoothing * options.half_width;
       wider.half_width *= kSmoothingStep) {
    if (wider.half_width > options.half_width) samples = samples_of(presses, touched, wider);
    double noise = 0.0;
    for (const PressSamples& press : samples) noise = std::max(noise, press.acceleration_noise);
    if (noise > kMaxNoiseShare * scales_of(samples)[0]) continue;
    ContactFit fit = fit_linear(samples, options);
    if (!fit.is_valid || !fit.mass.is_excited) return std::nullopt;
    options.half_width = wider.half_width;
    return fit;
  }
  return std::nullopt;
}

/// The uncertainty of the linear law's exponent, from the Hunt-Crossley fit.
void set_linear_exponent(const ContactFit& curved, ContactFit& linear) {
  if (!linear.is_valid || !curved.is_valid) return;
  linear.exponent.std = std::hypot(curved.exponent.std, curved.exponent.value - 1.0);
  linear.exponent.std = std::max(linear.exponent.std, kMinExponentStd);
}

/// The relative difference of two laws' penetrations, at its largest from a quarter of the presses'
/// largest force on.
double penetration_difference(const ContactFit& a, const ContactFit& b, double max_force) {
  double difference = 0.0;
  for (const double share : {0.25, 1.0}) {
    const auto log_depth = [&](const ContactFit& fit) {
      return std::log(share * max_force / fit.stiffness.value) / fit.exponent.value;
    };
    difference = std::max(difference, std::abs(log_depth(a) - log_depth(b)));
  }
  return difference;
}

double max_force_of(const std::vector<PressSamples>& presses) {
  double force = 0.0;
  for (const PressSamples& press : presses) {
    for (const ContactSample& sample : press.samples) force = std::max(force, sample.force);
  }
  return force;
}

/// Adds the share of a fixed exponent's std, by fits at one std below and above (sigma points).
void add_exponent_share(const std::vector<PressSamples>& presses, ContactFitOptions options,
                        ContactFit& fit) {
  if (!fit.is_valid || options.exponent_std <= 0.0) return;
  const double n = *options.exponent;
  ContactFit fits[2];
  for (const int i : {0, 1}) {
    options.exponent = std::max(1.0, n + (2 * i - 1) * options.exponent_std);
    fits[i] = fit_hunt_crossley(presses, options);
    if (!fits[i].is_valid) return;
  }
  const ContactFit &low = fits[0], &high = fits[1];
  const double scale = options.exponent_std / (high.exponent.value - low.exponent.value);
  // The change is that of the stiffness's logarithm: k changes by a factor of ten.
  const Eigen::Vector3d change(
      fit.stiffness.value * scale * std::log(high.stiffness.value / low.stiffness.value),
      scale * (high.damping.value - low.damping.value), options.exponent_std);
  fit.covariance += change * change.transpose();
  fit.stiffness.std = std::sqrt(fit.covariance(0, 0));
  fit.damping.std = std::sqrt(fit.covariance(1, 1));
  fit.exponent.std = options.exponent_std;
  fit.stiffness.is_excited = fit.stiffness.value > 2.0 * fit.stiffness.std;
  const double difference = scale * penetration_difference(low, high, max_force_of(presses));
  fit.penetration_std = std::hypot(fit.penetration_std, difference);
}

std::string proposal_for(const ContactIdentification& found) {
  const ContactFit& best = found.best();
  if (!best.is_valid) return "press deeper, or longer: no stiffness could be identified";
  if (!best.damping.is_excited) {
    return "press at several speeds, or modulate the press at 2 Hz, 1 mm: damping was not excited";
  }
  if (best.regressor == ContactRegressor::mass_damper_spring && !best.mass.is_excited) {
    return "modulate the press at 10 Hz, 1 mm: the contact's mass was not excited";
  }
  return {};
}

/// Takes the better of two hypotheses, a surface that stays and one that moves. They are compared
/// on the same presses, as along the local direction the force itself differs. `options` have the
/// smoothing of the first one.
void take_drifting_surface(std::span<const ForceMotion> presses, std::span<const ForceMotion> local,
                           const ContactFitOptions& options, ContactIdentification& found) {
  const ContactFit fixed = found.best();
  const auto short_presses =
      std::count_if(presses.begin(), presses.end(),
                    [&](const ForceMotion& press) { return is_short_press(press, options); });
  const bool are_short = 2 * short_presses > std::ssize(presses);
  if (are_short && short_presses < kMinShortPresses) return;
  ContactFit drifting = fit_drifting_surface(presses, options);
  const double min_gain =
      are_short ? std::min(options.min_moving_gain, kMinShortGain) : options.min_moving_gain;
  // At its bound the exponent asks for another law.
  const bool is_at_bound = found.chosen == ContactRegressor::hunt_crossley &&
                           fixed.exponent.value >= options.max_exponent;
  const bool is_fixed =
      fixed.is_valid && !is_at_bound && fixed.residual < min_gain * drifting.residual;
  if (!drifting.is_valid || is_fixed) return;
  found.proposal = fmt::format(
      "the surface moves under the presses: a law of one that stays leaves {:.2f} N unexplained, "
      "one that moves {:.2f} N; the damping is not identified, as a clock offset of "
      "some milliseconds would look the same",
      fixed.residual, drifting.residual);
  ContactFit along = fit_drifting_surface(local, options);
  if (along.is_valid) drifting = std::move(along);
  drifting.surface = fixed.surface;
  found.mass_damper_spring = std::move(drifting);
  found.chosen = ContactRegressor::mass_damper_spring;
}

}  // namespace

ContactIdentification identify_contact(std::span<const ForceMotion> presses,
                                       const ContactFitOptions& options,
                                       std::span<const ForceMotion> local) {
  PCAVR_REQUIRE(options.exponent.value_or(1.0) >= 1.0, *options.exponent);
  PCAVR_REQUIRE(local.empty() || local.size() == presses.size(), local.size());
  ContactIdentification found;
  std::vector<PressSamples> samples;
  for (std::size_t i = 0; i < presses.size(); ++i) {
    PressSamples cut = press_samples(presses[i], options);
    if (cut.samples.empty()) continue;
    samples.push_back(std::move(cut));
    found.touched.push_back(i);
  }
  if (samples.empty()) {
    found.proposal = proposal_for(found);
    return found;
  }
  if (options.exponent) {
    found.hunt_crossley = fit_hunt_crossley(samples, options);
    add_exponent_share(samples, options, found.hunt_crossley);
    found.chosen = ContactRegressor::hunt_crossley;
    found.proposal = proposal_for(found);
    return found;
  }
  found.mass_damper_spring = fit_linear(samples, options);
  ContactFitOptions smoothed = options;
  if (auto fit = fit_with_mass(presses, found.touched, samples, smoothed)) {
    found.mass_damper_spring = *std::move(fit);
  }
  if (options.drift_half_width <= 0.0) {
    found.hunt_crossley = fit_hunt_crossley(samples, options);
    set_linear_exponent(found.hunt_crossley, found.mass_damper_spring);
  }
  const ContactFit& linear = found.mass_damper_spring;
  const ContactFit& curved = found.hunt_crossley;
  const bool is_curved = curved.is_valid && curved.exponent.value > kMaxLinearExponent;
  const double tie = is_curved ? 1.0 + options.min_improvement : 1.0 - options.min_improvement;
  // A curved law that ends at an exponent of 1 would have its damping [N s/m^2] read as the linear
  // law's [N s/m].
  const bool is_distinct = curved.exponent.value > 1.0 || !linear.is_valid;
  if (curved.is_valid && is_distinct &&
      (!linear.is_valid ||
       normalised_misfit(samples, curved) < tie * normalised_misfit(samples, linear))) {
    found.chosen = ContactRegressor::hunt_crossley;
  }
  found.proposal = proposal_for(found);
  if (found.chosen == ContactRegressor::hunt_crossley) smoothed = options;
  if (options.drift_half_width <= 0.0) take_drifting_surface(presses, local, smoothed, found);
  return found;
}

}  // namespace pcavr
