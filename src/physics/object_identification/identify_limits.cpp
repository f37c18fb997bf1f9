// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/identify_limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/breakaway_motion.hpp"

#include "physics/object_identification/breakaway_lever.hpp"

namespace pcavr {
namespace {

constexpr double kRateHalfWidth = 0.020;  // [s] of tool's speed and force at the breakaway
constexpr double kMinRateFactor = 2.0;    // of the mean rate: it was loaded in steps

constexpr double kMaxNoise = 0.01;  // smoothed noise over force: a third of the drop after a peak
constexpr double kMaxHalfWidth = 0.030;  // [s] half width; the peak is wider than that

/// Smooths a weak push with a wider window: noise of some per cent of the force resembles the drop
/// after the peak. Loading is slow, so that the wider window does not flatten the peak.
void widen_smoothing(Contact& contact, BreakawayOptions options) {
  const Breakaway& found = contact.breakaway;
  const double noise_share = found.std / std::max(contact.peak_force, 1e-9);
  if (!found.is_found || noise_share <= kMaxNoise) return;
  // The noise decreases with the square root of the width.
  options.half_width =
      std::min(options.half_width * std::pow(noise_share / kMaxNoise, 2), kMaxHalfWidth);
  const Breakaway smoother = find_breakaway(contact.series(), options);
  if (smoother.is_found) contact.breakaway = smoother;
}

/// With the contact law's stiffness where the push has no line.
Breakaway with_stiffness(Breakaway breakaway, const std::optional<HuntCrossley>& contact_law) {
  if (!(breakaway.stiffness > 0.0) && contact_law && breakaway.force > 0.0) {
    breakaway.stiffness = breakaway.force / static_penetration(*contact_law, breakaway.force);
  }
  return breakaway;
}

/// The breakaway with the loading rate at its peak: after a hold just below the limit, the mean
/// rate says little about the inertia.
Breakaway with_final_rate(const Contact& contact,
                          const std::optional<HuntCrossley>& contact_law = {}) {
  Breakaway breakaway = with_stiffness(contact.breakaway, contact_law);
  const double half_width = std::max(kRateHalfWidth, 3.0 * mean_interval(contact.t));
  const SmoothedSample tool = smooth_at(contact.t, contact.tool, breakaway.t, half_width);
  const double rate = tool.is_valid ? breakaway.stiffness * tool.rate : 0.0;
  if (rate > kMinRateFactor * breakaway.loading_rate) breakaway.loading_rate = rate;
  return breakaway;
}

/// Raises an F_M that is uncertain to what sliding says of it, and withholds one that contradicts
/// it: false then.
bool bound_by_sliding(ObjectIdentification& result) {
  IdentifiedParameter& limit = result.limit_of_pushes.limit;
  const IdentifiedParameter& coulomb = result.friction.coulomb;
  const IdentifiedParameter bounded = limit_above_sliding(limit, coulomb);
  // A push that breaks away clearly below the sliding friction turns the object under its load.
  constexpr double kClearStds = 2.0;
  const double below = coulomb.value - limit.value;
  if (result.is_exponent_given && below > kClearStds * std::hypot(limit.std, coulomb.std)) {
    result.is_contact_off_centre = true;
  }
  const std::string contradiction = fmt::format(
      "the limiting friction of the pushes, {:.2f} N +- {:.2f} N, is below the sliding friction, "
      "{:.2f} N +- {:.2f} N",
      limit.value, limit.std, coulomb.value, coulomb.std);
  if (!bounded.is_excited) {
    result.notes.push_back(contradiction +
                           ": it is not used; push slowly through the centre of mass");
    result.limit.pushes = 0;
    return false;
  }
  if (limit.value < coulomb.value) {
    result.notes.push_back(contradiction +
                           fmt::format(", which it can't be: raised to {:.2f} N +- {:.2f} N",
                                       bounded.value, bounded.std));
  }
  limit = bounded;
  return true;
}

/// Nothing where the mass or the sliding friction is not known, or where forces contradict any
/// friction, as where the sensor's bias changes under a push. Without a contact law, that of each
/// push's own loading is to be set.
std::optional<PushedObject> pushed_object(const ContactCompliance& compliance,
                                          const FrictionPriors& priors,
                                          const ObjectIdentification& known) {
  const FrictionPosterior& friction = known.friction;
  const std::optional<ParameterValue>& mass = known.parameters.mass;
  if (!mass || !friction.is_valid || !(friction.coulomb.value > 0.0)) return std::nullopt;
  PushedObject object{.contact_law = compliance.law.value_or(HuntCrossley{}),
                      .compliance_std = compliance.std,
                      .damping_std = compliance.damping_std,
                      .mass = mass->value,
                      .mass_std = priors.mass_share,
                      .sliding = {friction.coulomb.value, friction.viscous.value},
                      .sliding_covariance = friction.covariance.bottomRightCorner<2, 2>(),
                      .stribeck_speed = priors.stribeck_speed};
  if (mass->std) object.mass_std = *mass->std / mass->value;
  return object;
}

// Samples under load, at rest, by which a push's line is its contact's.
constexpr int kMinRestSamples = 3;

/// Whether the object was loaded before it slid. Else the push begins with an impact: the first
/// forces exceed the sliding friction, and the line that was fitted to them is of a sliding object.
bool is_loaded_at_rest(const Contact& contact, double coulomb) {
  int samples = 0;
  for (std::size_t i = 0; i < contact.t.size() && contact.t[i] < contact.breakaway.t; ++i) {
    if (contact.t[i] < contact.breakaway.t_contact) continue;
    if (contact.force[i] > coulomb) break;
    ++samples;
  }
  return samples >= kMinRestSamples;
}

/// Whether inertia has a part in the push's peak.
bool is_fast(const Breakaway& breakaway, double mass, const OnsetOptions& options) {
  return inertial_overshoot(breakaway, mass) > options.max_acceleration_share * breakaway.force;
}

/// The limit of one push: the force less inertia, which needs the mass; else the force at the peak.
/// Not excited where the push begins with an impact, and no contact law says what of it is inertia.
LimitOfMotion limit_of(const Contact& push, std::optional<PushedObject> object,
                       const std::optional<HuntCrossley>& contact_law,
                       const std::optional<ParameterValue>& mass,
                       const IdentificationOptions& options) {
  const Breakaway breakaway = with_final_rate(push, contact_law);
  if (object && !contact_law) {
    if (!is_loaded_at_rest(push, object->sliding[0])) return {};
    object->contact_law = {breakaway.stiffness, 0.0, 1.0};
  }
  // Only fast pushes use the motion: in a slow push it could show no more than the small error of
  // the peak.
  if (object && is_fast(breakaway, object->mass, options.onset)) {
    const LimitOfMotion found =
        limit_by_motion(push.series(), breakaway, *object, options.breakaway_priors);
    if (found.limit.is_excited) return found;
  }
  LimitOfMotion found{{breakaway.force, breakaway.std, true}, 0.0};
  if (mass) {
    found.limit = limit_of_push(push.series(), breakaway, contact_law, mass->value, options.onset);
  }
  if (breakaway.loading_rate > 0.0) {
    const double loading_time = found.limit.value / breakaway.loading_rate;
    found.shared_std = limit_rate_std(found.limit.value, loading_time, options.breakaway_priors);
  }
  return found;
}

/// The part of F_M [N] that is hidden in a push that turns the object as it breaks away.
IdentifiedParameter hidden_in(const Contact& push, double radius,
                              const IdentifiedParameter& coulomb, const IdentifiedParameter& limit,
                              const BreakawayPriors& priors) {
  if (!(radius > 0.0) || !coulomb.is_excited) return {};
  // An excess may be hidden in the noise.
  const double excess = std::max(limit.value - coulomb.value, std::hypot(limit.std, coulomb.std));
  return excess_hidden_by_turning(excess, coulomb.value, radius * push.breakaway_turning, priors);
}

}  // namespace

std::vector<Contact*> pushes_at_limit(const std::vector<Contact*>& all,
                                      std::vector<Contact*> centred, const BodyMotion& body,
                                      const PathView& tip, double tool_radius,
                                      const IdentifiedParameter& radius,
                                      const IdentificationOptions& options,
                                      ObjectIdentification& result) {
  if (result.friction.coulomb.is_excited) {
    std::erase_if(centred, [&](const Contact* push) {
      const double t = yield_instant(*push, result.friction.coulomb.value);
      return std::abs(lever_at(t, *push, body, tip, tool_radius)) > kMaxCentredLever;
    });
  }
  const std::size_t count = all.size() - centred.size();
  if (count == 0) return centred;
  std::vector<Contact*> slow;
  const std::optional<ParameterValue>& mass = result.parameters.mass;
  if (centred.empty() && !body.tracked.empty() && radius.is_excited && mass) {
    std::copy_if(all.begin(), all.end(), std::back_inserter(slow), [&](Contact* push) {
      return !is_fast(with_final_rate(*push), mass->value, options.onset);
    });
  }
  std::string note = std::to_string(count) + (count == 1 ? " push" : " pushes") +
                     " off the centre of mass: not used for the limiting friction";
  if (body.tracked.empty()) note += ", nor, without tracking, for the sliding friction";
  if (!slow.empty()) {
    note += fmt::format(
        ", but for the {} slow ones, as none is through it: less certain, by their moment and the "
        "friction radius",
        slow.size());
    centred = std::move(slow);
  }
  result.notes.push_back(std::move(note));
  return centred;
}

void find_limits(const std::vector<Contact*>& pushes, const ContactCompliance& compliance,
                 const IdentifiedParameter& radius, const IdentificationOptions& options,
                 ObjectIdentification& result) {
  const std::optional<PushedObject> object =
      pushed_object(compliance, options.friction_priors, result);
  std::vector<Breakaway> breakaways;
  std::vector<double> shared;  // stds that do not average out over the pushes
  int impacts = 0;
  for (Contact* push : pushes) {
    widen_smoothing(*push, options.inputs.segmentation.breakaway);
    Breakaway breakaway = push->breakaway;
    if (breakaway.is_found) {
      LimitOfMotion limit =
          limit_of(*push, object, compliance.law, result.parameters.mass, options);
      if (radius.is_excited && limit.limit.is_excited) {
        limit = limit_with_moment(limit, push->breakaway_lever, radius);
      }
      const IdentifiedParameter hidden = hidden_in(*push, radius.value, result.friction.coulomb,
                                                   limit.limit, options.breakaway_priors);
      // The share varies too much from body to body to be added: added, it worsened pushes that
      // hardly turn.
      limit.shared_std = std::hypot(limit.shared_std, hidden.value, hidden.std);
      push->limit = limit.limit;
      push->limit_shared_std = limit.shared_std;
      if (push->limit.is_excited) shared.push_back(limit.shared_std);
      breakaway.is_found = push->limit.is_excited;
      breakaway.force = push->limit.value;
      breakaway.std = std::hypot(push->limit.std, limit.shared_std);
      if (!breakaway.is_found) ++impacts;
    }
    breakaways.push_back(breakaway);
  }
  if (impacts > 0) {
    result.notes.push_back(fmt::format(
        "{} {} with an impact: not used for the limiting friction, as the object slides before its "
        "contact is seen loaded; touch it slower, or press along z to identify the contact law",
        impacts, impacts == 1 ? "push begins" : "pushes begin"));
  }
  result.limit = limiting_friction(breakaways, options.limiting_friction);
  std::vector<IdentifiedParameter> limits;
  limits.reserve(pushes.size());
  for (const Contact* push : pushes) limits.push_back(push->limit);
  for (const std::size_t i : result.limit.left_out) {
    limits[i].is_excited = false;
    const std::string text = fmt::format(
        "the push at t = {:.3f} s ({:.2f} N +- {:.2f} N) is not counted for the limiting "
        "friction: it is an outlier",
        pushes[i]->begin, breakaways[i].force, breakaways[i].std);
    result.notes.push_back(text);
  }
  if (result.limit.pushes == 0) return;
  const FrictionPriors& priors = options.friction_priors;
  result.limit_of_pushes = combine_limits(limits, priors.scatter, priors.scatter_factor);
  IdentifiedParameter& mean = result.limit_of_pushes.limit;
  mean.std = std::hypot(mean.std, median(std::move(shared)));
  if (!bound_by_sliding(result)) return;
  ObjectParameters& parameters = result.parameters;
  parameters.limiting_static_friction = as_value(result.limit_of_pushes.limit);
  parameters.limiting_static_friction_scatter = ParameterValue{result.limit_of_pushes.scatter, {}};
  ParameterValue rate{result.limit.loading_rate, {}};
  if (result.limit.pushes > 1) rate.std = result.limit.loading_rate_std;
  if (rate.value > 0.0) parameters.loading_rate = rate;
  for (const char* key :
       {"limiting_static_friction", "limiting_static_friction_scatter", "loading_rate"}) {
    parameters.sources.pushes[key] = static_cast<int>(result.limit.pushes);
  }
}

double limit_rate_std(double limit, double loading_time, const BreakawayPriors& priors) {
  return limit * priors.rate_share * priors.rate_duration / (priors.rate_duration + loading_time);
}

}  // namespace pcavr
