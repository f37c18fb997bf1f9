// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Online identification of mass and friction from the pushes so far.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/inertial_peak.hpp"

#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {
namespace {

/// [Ns/m] The mean of the prior.
double expected_viscous(const FrictionPriors& priors) { return 0.5 * priors.max_viscous; }

/// Coulomb friction by a push's own slides: the median force along the push, less the viscous
/// share, of which only the prior is known. Its std has a tenth for inertia and for a force that
/// does not go through the centre; not excited without a slide.
IdentifiedParameter friction_in(const Contact& contact, const FrictionPriors& priors) {
  constexpr double kForceError = 0.1;
  constexpr double kMinPath = 5e-4;  // [m] of the tip: over less, the force still settles
  std::vector<double> forces;
  double path = 0.0, duration = 0.0;
  for (const SlideInterval& slide : contact.slides) {
    const auto from = std::lower_bound(contact.t.begin(), contact.t.end(), slide.begin);
    const auto to = std::upper_bound(from, contact.t.end(), slide.end);
    if (to - from < 2) continue;
    const auto first = static_cast<std::size_t>(from - contact.t.begin());
    const auto last = static_cast<std::size_t>(to - contact.t.begin()) - 1;
    path += contact.tool[last] - contact.tool[first];
    duration += contact.t[last] - contact.t[first];
    forces.insert(forces.end(), contact.force.begin() + static_cast<std::ptrdiff_t>(first),
                  contact.force.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  }
  if (path < kMinPath) return {};
  const double force = median(std::move(forces));
  const double viscous = priors.max_viscous * path / duration;
  const double coulomb = force - expected_viscous(priors) * path / duration;
  return {coulomb, std::hypot(kForceError * force, viscous / std::sqrt(12.0)), true};
}

/// Force under which the newest push slid, by its samples; at least one. Its scatter about other
/// pushes is no error of it: `model_error` allows for it.
SlidingForce force_of_newest(const std::vector<FrictionSample>& samples, double mass,
                             double support_size_share) {
  const std::size_t newest = samples.back().push;
  double count = 0.0, force = 0.0, squares = 0.0, speed = 0.0, rotation = 0.0;
  for (const FrictionSample& sample : samples) {
    if (sample.push != newest) continue;
    const double friction = sample.force - mass * sample.acceleration;
    count += 1.0, force += friction, squares += friction * friction;
    speed += sample.speed, rotation += sample.rotation_share;
  }
  force /= count;
  const double variance = std::max(squares / count - force * force, 0.0);
  // Windows of smoothing overlap: every other sample is independent.
  const double noise = std::sqrt(2.0 * variance / count);
  return {speed / count, force, std::hypot(noise, support_size_share * rotation / count * force)};
}

/// mu M g + B v [N] by known parameters; without mass, coefficient or viscous friction their share
/// is left out.
ParameterValue sliding_force(const ObjectParameters& known, double weight, double speed,
                             double default_std) {
  const ParameterValue mu = known.sliding_friction_coefficient.value_or(ParameterValue{});
  const ParameterValue viscous = known.viscous_friction.value_or(ParameterValue{});
  const double force = mu.value * weight + viscous.value * speed;
  // The two compensate each other's errors.
  const double std =
      std::max(mu.std.value_or(default_std * mu.value) * weight, viscous.std.value_or(0.0) * speed);
  return {force, std};
}

}  // namespace

void OnlineIdentification::assume_friction(const Contact& push) {
  const bool has_friction = known_.sliding_friction_coefficient && !is_friction_assumed_;
  if (!known_.mass || has_friction) return;
  const IdentifiedParameter coulomb = friction_in(push, options_.friction_priors);
  if (!coulomb.is_excited || !(coulomb.value > 0.0)) return;
  const double weight = known_.mass->value * options_.sliding.gravity;
  known_.sliding_friction_coefficient =
      ParameterValue{coulomb.value / weight, coulomb.std / weight};
  known_.viscous_friction = ParameterValue{expected_viscous(options_.friction_priors),
                                           options_.friction_priors.max_viscous / std::sqrt(12.0)};
  is_friction_assumed_ = has_changed_ = true;
  assume_limit(coulomb.value);
}

void OnlineIdentification::assume_limit(double coulomb) {
  if (known_.limiting_static_friction && !is_limit_assumed_) return;
  const double excess = options_.breakaway_priors.excess * coulomb;
  known_.limiting_static_friction = ParameterValue{coulomb + excess, excess};
  is_limit_assumed_ = has_changed_ = true;
}

std::optional<ObjectIdentifier> OnlineIdentification::next_search() {
  if (!std::exchange(is_search_due_, false)) return std::nullopt;
  return identifier(given_, IdentificationGoal::friction);
}

bool OnlineIdentification::accept(const ObjectIdentifier::Result& result) {
  has_changed_ = false;
  const ObjectIdentification& found = result.object;
  const auto newest = std::find_if(
      result.contacts.rbegin(), result.contacts.rend(),
      [this](const auto& contact) { return !is_press(contact) && !contact.slides.empty(); });
  // The inertia of a fast push is still in its peak without the sliding friction.
  const bool is_inertial =
      !found.friction.is_valid && newest != result.contacts.rend() &&
      is_inertial_peak(newest->breakaway, friction_in(*newest, options_.friction_priors));
  if (!is_inertial) accept_limit(found);
  accept_sliding(found);
  accept_radius(found);
  accept_tool_friction(found);
  return has_changed_;
}

void OnlineIdentification::note_contradiction(double limit, double sliding) {
  contradiction_ = fmt::format(
      "a breakaway at {:.2f} N is below the sliding friction, {:.2f} N: it is not used to identify",
      limit, sliding);
}

void OnlineIdentification::check_breakaway(Contact& push) {
  const IdentifiedParameter sliding = friction_in(push, options_.friction_priors);
  const auto contradicts = [&](double limit, double std) {
    if (limit_above_sliding({limit, std, true}, sliding).is_excited) return false;
    note_contradiction(limit, sliding.value);
    return true;
  };
  const std::optional<ParameterValue>& learned = known_.limiting_static_friction;
  if (learned && contradicts(learned->value, learned->std.value_or(0.0))) discard_learned_limit();
  Breakaway& breakaway = push.breakaway;
  if (breakaway.is_found && contradicts(breakaway.force, breakaway.std)) breakaway.is_found = false;
}

void OnlineIdentification::accept_limit(const ObjectIdentification& found) {
  const IdentifiedParameter& limit = found.limit_of_pushes.limit;
  if (!limit.is_excited) return;
  if (found.limit.pushes == 0) {
    note_contradiction(limit.value, found.friction.coulomb.value);
    return discard_learned_limit();
  }
  std::optional<ParameterValue>& known = known_.limiting_static_friction;
  const ParameterValue value = *found.parameters.limiting_static_friction;
  // An earlier value was found in these pushes, too, or is assumed: the scatter that later pushes
  // show may widen the std.
  const bool is_learned = known && !given_.limiting_static_friction;
  if (!is_learned && !accept(&ObjectParameters::limiting_static_friction, value)) return;
  known = value;
  is_limit_assumed_ = false;
  has_changed_ = true;
  known_.limiting_static_friction_scatter = found.parameters.limiting_static_friction_scatter;
  known_.loading_rate = found.parameters.loading_rate;
}

void OnlineIdentification::discard_learned_limit() {
  std::optional<ParameterValue>& limit = known_.limiting_static_friction;
  if (!limit || given_.limiting_static_friction) return;
  limit.reset();
  is_limit_assumed_ = false;
  has_changed_ = true;
}

bool OnlineIdentification::is_sliding_contradicted(const std::vector<FrictionSample>& samples,
                                                   double mass) const {
  const SlidingForce newest =
      force_of_newest(samples, mass, options_.friction_priors.support_size_share);
  const ParameterValue old = sliding_force(
      known_, known_.mass.value_or(ParameterValue{mass}).value * options_.sliding.gravity,
      newest.speed, options_.default_relative_std);
  return is_contradicted(old, {newest.force, newest.std});
}

void OnlineIdentification::accept_sliding(const ObjectIdentification& found) {
  const std::vector<SlidingForce>& forces = found.friction.sliding_force;
  if (!found.friction.coefficient.is_excited || forces.empty()) return;
  const ObjectParameters& next = found.parameters;
  if (!next.mass || !next.sliding_friction_coefficient || !next.viscous_friction) return;
  const SlidingForce& middle = forces[forces.size() / 2];
  const double relative_std = middle.std / middle.force;
  if (known_.sliding_friction_coefficient && !is_friction_assumed_) {
    const bool was_given = given_.sliding_friction_coefficient.has_value();
    const bool is_more_certain = !was_given && relative_std <= kMaxStdRatio * sliding_force_std_;
    const bool is_mass_contradicted =
        !found.is_mass_given && is_contradicted(known_.mass, *next.mass);
    if (!is_more_certain && !is_mass_contradicted &&
        !is_sliding_contradicted(found.slide_samples, next.mass->value)) {
      return;
    }
  }
  known_.mass = next.mass;
  known_.sliding_friction_coefficient = next.sliding_friction_coefficient;
  known_.viscous_friction = next.viscous_friction;
  given_.sliding_friction_coefficient.reset();
  given_.viscous_friction.reset();
  sliding_force_std_ = relative_std;
  is_friction_assumed_ = false;
  has_changed_ = true;
  assume_limit(next.sliding_friction_coefficient->value * next.mass->value *
               options_.sliding.gravity);
}

}  // namespace pcavr
