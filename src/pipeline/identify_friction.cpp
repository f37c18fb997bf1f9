// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// A push past the centre by more than this meets less friction, because the object turns, too:
/// 1.5 % at a friction radius of 60 mm.
constexpr double kCentred = 0.010;  // [m]

constexpr double kQuiet = 0.01;  // smoothed noise over force: a third of the drop that ends a peak
constexpr double kWidestSmoothing = 0.030;  // [s] half width; the peak is wider than that

bool is_centred(const IdentifiedContact* push) { return std::abs(push->lever) <= kCentred; }

void take_sliding(std::optional<double> weighed, ObjectIdentification& result) {
  const SlidingIdentification& sliding = result.sliding;
  ObjectParameters& parameters = result.parameters;
  if (!sliding.is_valid) return;
  if (sliding.mass.is_excited) {
    parameters.mass = as_value(sliding.mass);
  } else if (weighed) {
    parameters.mass = ParameterValue{*weighed, {}};
  }
  if (sliding.coefficient.is_excited && sliding.coefficient.value > 0.0) {
    parameters.sliding_friction_coefficient = as_value(sliding.coefficient);
  }
  parameters.viscous_friction.reset();
  if (sliding.viscous.is_excited && sliding.viscous.value >= 0.0) {
    parameters.viscous_friction = as_value(sliding.viscous);
  }
}

/// A weak push is smoothed for longer: where the sensor's noise is some per cent of the force, it
/// looks like the drop that ends the peak. Slow loading keeps a wider window from cutting the peak.
void smooth_longer(ContactEpisode& episode) {
  const Breakaway& found = episode.breakaway;
  const double noise_share = found.deviation / std::max(episode.peak_force, 1e-9);
  if (!found.is_found || noise_share <= kQuiet) return;
  // The noise falls with the root of the width.
  BreakawayOptions options;
  options.half_width =
      std::min(options.half_width * std::pow(noise_share / kQuiet, 2), kWidestSmoothing);
  const Breakaway smoother = find_breakaway(episode.series(), options);
  if (smoother.is_found) episode.breakaway = smoother;
}

/// F_M of each push: the friction's own limit, which needs the mass; else the force at the peak.
void find_limits(const std::vector<IdentifiedContact*>& pushes,
                 const std::optional<Compliance>& compliance, ObjectIdentification& result) {
  std::vector<Breakaway> breakaways;
  for (IdentifiedContact* push : pushes) {
    smooth_longer(push->episode);
    Breakaway breakaway = push->episode.breakaway;
    if (breakaway.is_found) {
      push->limit = {breakaway.force, breakaway.deviation, true};
      if (compliance && result.parameters.mass) {
        push->limit = limit_of_push(push->episode.series(), breakaway, *compliance,
                                    result.parameters.mass->value);
      }
      breakaway.force = push->limit.value;
      breakaway.deviation = push->limit.deviation;
    }
    breakaways.push_back(breakaway);
  }
  result.limit = limiting_friction(breakaways);
  for (const std::size_t i : result.limit.left_out) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the push at t = %.3f s (%.2f N +- %.2f N) is not counted for the limiting "
                  "friction: it is unlike the others",
                  pushes[i]->episode.begin, breakaways[i].force, breakaways[i].deviation);
    result.notes.push_back(text);
  }
  if (result.limit.pushes == 0) return;
  ParameterValue limit{result.limit.mean, result.limit.deviation_of_mean};
  ParameterValue rate{result.limit.loading_rate, {}};
  if (result.limit.pushes > 1) {
    limit.deviation = result.limit.deviation;
    rate.deviation = result.limit.loading_rate_deviation;
  }
  result.parameters.limiting_static_friction = limit;
  if (rate.value > 0.0) result.parameters.loading_rate = rate;
}

}  // namespace

void identify_friction_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                          std::optional<double> weighed, ObjectIdentification& result) {
  std::vector<IdentifiedContact*> pushes = contacts_of(contacts, object, false);
  const auto aside = std::partition(pushes.begin(), pushes.end(), is_centred);
  const auto turned = static_cast<std::size_t>(pushes.end() - aside);
  if (turned > 0) {
    result.notes.push_back(std::to_string(turned) + (turned == 1 ? " push" : " pushes") +
                           " past the centre of mass: used for turning, not for the limiting and "
                           "the sliding friction");
  }
  pushes.erase(aside, pushes.end());
  const std::optional<Compliance> compliance = compliance_of(result.parameters);
  if (compliance) {
    std::vector<ForceMotion> slides;
    for (const IdentifiedContact* push : pushes) {
      if (push->episode.kind == ContactKind::slide) slides.push_back(push->episode.series());
    }
    SlidingOptions options;
    options.mass = weighed;
    if (!weighed && result.parameters.mass) options.mass = result.parameters.mass->value;
    result.sliding = identify_sliding(slides, *compliance, options);
    take_sliding(weighed, result);
  } else if (!pushes.empty()) {
    result.notes.push_back(
        "without a contact law the object's own motion is not known, only the tool's: press it "
        "along z, or give --parameters");
  }
  find_limits(pushes, compliance, result);
}

}  // namespace pcavr
