// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "identify_parts.hpp"
#include "identify_slides.hpp"

namespace pcavr {
namespace {

/// A push with a larger lever arm about the centre meets less friction, because the object also
/// rotates: 1.5 % at a friction radius of 60 mm.
constexpr double kMaxCentredLever = 0.010;  // [m]

/// Stds beyond which a weighed mass contradicts the one that accelerations show.
constexpr double kMassContradiction = 5.0;

constexpr double kRateHalfWidth = 0.020;  // [s] of the tool's speed at the breakaway
constexpr double kMinRateFactor = 2.0;    // of the mean rate: it was loaded in steps
/// Std of F_M, as a share, where it was loaded within no time; half of it within `kRateDuration`.
constexpr double kRateShare = 0.10;
constexpr double kRateDuration = 0.10;  // [s]

constexpr double kMaxNoise = 0.01;  // smoothed noise over force: a third of the drop after a peak
constexpr double kMaxHalfWidth = 0.030;  // [s] half width; the peak is wider than that

bool is_centred(const IdentifiedContact* push) { return std::abs(push->lever) <= kMaxCentredLever; }

/// With the mass that was weighed, and without: a mass that the motion itself excites checks it.
FrictionPosterior infer(const std::vector<FrictionSample>& samples,
                        std::optional<double> given_mass, IdentifiedParameter& mass) {
  const FrictionPosterior alone = infer_friction(samples);
  mass = alone.mass;
  if (!given_mass) return alone;
  const bool is_contradicted =
      mass.is_excited && std::abs(mass.value - *given_mass) > kMassContradiction * mass.std;
  if (is_contradicted) return alone;
  FrictionPriors priors;
  priors.mass = given_mass;
  return infer_friction(samples, priors);
}

void take_sliding(std::optional<double> given_mass, const IdentifiedParameter& mass,
                  ObjectIdentification& result) {
  const FrictionPosterior& found = result.friction;
  if (!found.is_valid) return;
  SlidingIdentification& sliding = result.sliding;
  sliding.is_valid = true;
  sliding.mass = mass;
  sliding.coulomb = found.coulomb;
  sliding.viscous = found.viscous;
  sliding.coefficient = found.coefficient;
  sliding.proposal.clear();
  if (!mass.is_excited || !found.viscous.is_excited) {
    sliding.proposal = "modulate the push at 2 Hz, 3 mm, on 60 mm/s, without stopping: ";
    sliding.proposal += mass.is_excited ? "viscous friction was" : "the mass was";
    sliding.proposal += " not excited";
  }
  ObjectParameters& parameters = result.parameters;
  if (mass.is_excited) {
    parameters.mass = as_value(mass);
  } else if (given_mass) {
    parameters.mass = ParameterValue{*given_mass, {}};
  }
  if (found.coefficient.is_excited && found.coefficient.value > 0.0) {
    parameters.sliding_friction_coefficient = as_value(found.coefficient);
    // Excited or not: only both together give the force at the speeds that were pushed.
    parameters.viscous_friction = as_value(found.viscous);
  }
}

/// Smooths a weak push with a wider window: noise of some per cent of the force resembles the drop
/// after the peak. Loading is slow, so that the wider window does not flatten the peak.
void widen_smoothing(ContactEpisode& episode) {
  const Breakaway& found = episode.breakaway;
  const double noise_share = found.std / std::max(episode.peak_force, 1e-9);
  if (!found.is_found || noise_share <= kMaxNoise) return;
  // The noise decreases with the square root of the width.
  BreakawayOptions options;
  options.half_width =
      std::min(options.half_width * std::pow(noise_share / kMaxNoise, 2), kMaxHalfWidth);
  const Breakaway smoother = find_breakaway(episode.series(), options);
  if (smoother.is_found) episode.breakaway = smoother;
}

/// The breakaway with the loading rate at its peak: after a hold just below the limit, the mean
/// rate says little about the inertia.
Breakaway with_final_rate(const ContactEpisode& episode) {
  Breakaway breakaway = episode.breakaway;
  const SmoothedSample tool = smooth_at(episode.t, episode.tool, breakaway.t, kRateHalfWidth);
  const double rate = tool.is_valid ? breakaway.stiffness * tool.rate : 0.0;
  if (rate > kMinRateFactor * breakaway.loading_rate) breakaway.loading_rate = rate;
  return breakaway;
}

/// Std [N] of F_M as the dependence of friction's limit on the loading rate: under fast loading an
/// object breaks loose before its contacts have adapted [Canudas de Wit et al. 1995].
double rate_std(const LimitingFriction& limit) {
  if (!(limit.loading_rate > 0.0)) return 0.0;
  const double duration = limit.mean / limit.loading_rate;
  return limit.mean * kRateShare * kRateDuration / (kRateDuration + duration);
}

/// F_M of each push: the limiting static friction without inertia, which needs the mass; else the
/// force at the peak. F_M of all that count: with the scatter between pushes.
void find_limits(const std::vector<IdentifiedContact*>& pushes,
                 const std::optional<HuntCrossley>& contact_law, ObjectIdentification& result) {
  std::vector<Breakaway> breakaways;
  for (IdentifiedContact* push : pushes) {
    widen_smoothing(push->episode);
    Breakaway breakaway = push->episode.breakaway;
    if (breakaway.is_found) {
      push->limit = {breakaway.force, breakaway.std, true};
      if (contact_law && result.parameters.mass) {
        push->limit = limit_of_push(push->episode.series(), with_final_rate(push->episode),
                                    *contact_law, result.parameters.mass->value);
      }
      breakaway.force = push->limit.value;
      breakaway.std = push->limit.std;
    }
    breakaways.push_back(breakaway);
  }
  result.limit = limiting_friction(breakaways);
  std::vector<IdentifiedParameter> limits;
  for (const IdentifiedContact* push : pushes) limits.push_back(push->limit);
  for (const std::size_t i : result.limit.left_out) {
    limits[i].is_excited = false;
    const std::string text = fmt::format(
        "the push at t = {:.3f} s ({:.2f} N +- {:.2f} N) is not counted for the limiting "
        "friction: it is an outlier",
        pushes[i]->episode.begin, breakaways[i].force, breakaways[i].std);
    result.notes.push_back(text);
  }
  if (result.limit.pushes == 0) return;
  const FrictionPriors priors;
  result.limit_of_pushes = combine_limits(limits, priors.scatter, priors.scatter_factor);
  IdentifiedParameter& mean = result.limit_of_pushes.limit;
  mean.std = std::hypot(mean.std, rate_std(result.limit));
  ObjectParameters& parameters = result.parameters;
  parameters.limiting_static_friction = as_value(result.limit_of_pushes.limit);
  parameters.limiting_static_friction_scatter = ParameterValue{result.limit_of_pushes.scatter, {}};
  ParameterValue rate{result.limit.loading_rate, {}};
  if (result.limit.pushes > 1) rate.std = result.limit.loading_rate_std;
  if (rate.value > 0.0) parameters.loading_rate = rate;
}

}  // namespace

void identify_friction_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                          std::optional<double> given_mass, const BodyMotion& body,
                          const PathView& tip, double tool_radius, ObjectIdentification& result) {
  std::vector<IdentifiedContact*> pushes = contacts_of(contacts, object, false);
  const std::vector<IdentifiedContact*> all = pushes;
  const auto off_centre = std::stable_partition(pushes.begin(), pushes.end(), is_centred);
  const auto off_centre_count = static_cast<std::size_t>(pushes.end() - off_centre);
  pushes.erase(off_centre, pushes.end());
  if (off_centre_count > 0) {
    const bool is_tracked = !body.tracked.empty();
    result.notes.push_back(std::to_string(off_centre_count) +
                           (off_centre_count == 1 ? " push" : " pushes") +
                           " off the centre of mass: not used for the limiting friction" +
                           (is_tracked ? "" : ", nor, without tracking, for the sliding friction"));
  }
  const std::optional<HuntCrossley> contact_law = contact_law_of(result.parameters);
  std::optional<double> known_mass = given_mass;
  if (!known_mass && result.parameters.mass) known_mass = result.parameters.mass->value;
  if (contact_law) {
    std::vector<ForceMotion> slides;
    for (const IdentifiedContact* push : pushes) {
      if (push->episode.kind == ContactKind::slide) slides.push_back(push->episode.series());
    }
    SlidingOptions options;
    options.mass = known_mass;
    result.sliding = identify_sliding(slides, *contact_law, options);
  }
  const std::vector<FrictionSample> samples =
      friction_samples(body.tracked.empty() ? pushes : all, contact_law, body, tip, tool_radius);
  IdentifiedParameter mass;
  result.friction = infer(samples, known_mass, mass);
  take_sliding(given_mass, mass, result);
  find_limits(pushes, contact_law, result);
}

}  // namespace pcavr
