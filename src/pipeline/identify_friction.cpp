// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// A push with a larger lever arm about the centre meets less friction, because the object also
/// rotates: 1.5 % at a friction radius of 60 mm.
constexpr double kMaxCentredLever = 0.010;  // [m]

constexpr double kMaxNoise = 0.01;  // smoothed noise over force: a third of the drop after a peak
constexpr double kMaxHalfWidth = 0.030;  // [s] half width; the peak is wider than that

bool is_centred(const IdentifiedContact* push) { return std::abs(push->lever) <= kMaxCentredLever; }

void take_sliding(std::optional<double> given_mass, ObjectIdentification& result) {
  const SlidingIdentification& sliding = result.sliding;
  ObjectParameters& parameters = result.parameters;
  if (!sliding.is_valid) return;
  if (sliding.mass.is_excited) {
    parameters.mass = as_value(sliding.mass);
  } else if (given_mass) {
    parameters.mass = ParameterValue{*given_mass, {}};
  }
  if (sliding.coefficient.is_excited && sliding.coefficient.value > 0.0) {
    parameters.sliding_friction_coefficient = as_value(sliding.coefficient);
  }
  parameters.viscous_friction.reset();
  if (sliding.viscous.is_excited && sliding.viscous.value >= 0.0) {
    parameters.viscous_friction = as_value(sliding.viscous);
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

/// F_M of each push: the limiting static friction without inertia, which needs the mass; else the
/// force at the peak.
void find_limits(const std::vector<IdentifiedContact*>& pushes,
                 const std::optional<Compliance>& compliance, ObjectIdentification& result) {
  std::vector<Breakaway> breakaways;
  for (IdentifiedContact* push : pushes) {
    widen_smoothing(push->episode);
    Breakaway breakaway = push->episode.breakaway;
    if (breakaway.is_found) {
      push->limit = {breakaway.force, breakaway.std, true};
      if (compliance && result.parameters.mass) {
        push->limit = limit_of_push(push->episode.series(), breakaway, *compliance,
                                    result.parameters.mass->value);
      }
      breakaway.force = push->limit.value;
      breakaway.std = push->limit.std;
    }
    breakaways.push_back(breakaway);
  }
  result.limit = limiting_friction(breakaways);
  for (const std::size_t i : result.limit.left_out) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the push at t = %.3f s (%.2f N +- %.2f N) is not counted for the limiting "
                  "friction: it is an outlier",
                  pushes[i]->episode.begin, breakaways[i].force, breakaways[i].std);
    result.notes.push_back(text);
  }
  if (result.limit.pushes == 0) return;
  ParameterValue limit{result.limit.mean, result.limit.std_of_mean};
  ParameterValue rate{result.limit.loading_rate, {}};
  if (result.limit.pushes > 1) {
    limit.std = result.limit.std;
    rate.std = result.limit.loading_rate_std;
  }
  result.parameters.limiting_static_friction = limit;
  if (rate.value > 0.0) result.parameters.loading_rate = rate;
}

}  // namespace

void identify_friction_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                          std::optional<double> given_mass, ObjectIdentification& result) {
  std::vector<IdentifiedContact*> pushes = contacts_of(contacts, object, false);
  const auto off_centre = std::partition(pushes.begin(), pushes.end(), is_centred);
  const auto off_centre_count = static_cast<std::size_t>(pushes.end() - off_centre);
  if (off_centre_count > 0) {
    result.notes.push_back(std::to_string(off_centre_count) +
                           (off_centre_count == 1 ? " push" : " pushes") +
                           " off the centre of mass: used for the friction radius, not for the "
                           "limiting and sliding friction");
  }
  pushes.erase(off_centre, pushes.end());
  const std::optional<Compliance> compliance = compliance_of(result.parameters);
  if (compliance) {
    std::vector<ForceMotion> slides;
    for (const IdentifiedContact* push : pushes) {
      if (push->episode.kind == ContactKind::slide) slides.push_back(push->episode.series());
    }
    SlidingOptions options;
    options.mass = given_mass;
    if (!given_mass && result.parameters.mass) options.mass = result.parameters.mass->value;
    result.sliding = identify_sliding(slides, *compliance, options);
    take_sliding(given_mass, result);
  } else if (!pushes.empty()) {
    result.notes.push_back(
        "without a contact law only the tool's motion is known, not the object's: press it "
        "along z, or give --parameters");
  }
  find_limits(pushes, compliance, result);
}

}  // namespace pcavr
