// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/object_learner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/core.h>

#include "pcavr/contact/hunt_crossley.hpp"
#include "pcavr/core/median.hpp"
#include "pcavr/identification/contact_fit.hpp"
#include "pcavr/identification/friction_posterior.hpp"
#include "pcavr/identification/inertial_peak.hpp"
#include "pcavr/identification/limit_of_pushes.hpp"
#include "pcavr/identification/path_view.hpp"
#include "pcavr/identification/sliding.hpp"

namespace pcavr {
namespace {

// A new estimate from more data replaces the old one up to this ratio of standard deviations.
constexpr double kMaxStdRatio = 1.2;
// A peak this near to the force at which the sensor saturates is cut off.
constexpr double kSaturatedRatio = 0.98;
// [samples] Fewer do not determine the contact law's three parameters.
constexpr std::size_t kMinContactSamples = 30;
// Cosine between the mean forces of two presses on the same face: 1 degree, of noise and friction.
constexpr double kSamePressDirection = 0.9998;
// Of the exponent that holds beyond the forces that were seen: a third of what laws range over.
constexpr double kExponentModelStd = 0.25;
// Of breakaways: their standard deviation needs more contacts than are fitted together.
constexpr std::size_t kMaxStoredContacts = 20;

ParameterValue value_of(const IdentifiedParameter& parameter) {
  return {parameter.value, parameter.std};
}

/// End of a push's static phase: the breakaway alarm, at the latest the first slide.
double static_until(const ContactEpisode& contact) {
  double until = contact.t.back();
  if (contact.breakaway.t_alarm > 0.0) until = std::min(until, contact.breakaway.t_alarm);
  if (!contact.slides.empty()) until = std::min(until, contact.slides.front().begin);
  return until;
}

ForceMotion part_until(const ContactEpisode& contact, double until) {
  const auto end = std::upper_bound(contact.t.begin(), contact.t.end(), until);
  const auto count = static_cast<std::size_t>(end - contact.t.begin());
  return {std::span(contact.t).first(count), std::span(contact.tool).first(count),
          std::span(contact.force).first(count), contact.tool_noise};
}

/// Coulomb friction where only the whole friction at a speed [m/s] is known: less the viscous
/// share, of which only the prior is known, and with the relative error of the rest.
IdentifiedParameter coulomb_of(double force, double speed, double relative_std) {
  const double viscous = FrictionPriors().max_viscous * std::max(speed, 0.0);
  return {force - 0.5 * viscous, std::hypot(relative_std * force, viscous / std::sqrt(12.0)), true};
}

/// The linear law of a young contact, whose force has not risen far enough to show an exponent:
/// with one parameter less it is known sooner. What the other law's penetration differs by at
/// `force` [N] is part of its std.
ContactFit preliminary_law(const ContactIdentification& found, double force) {
  ContactFit linear = found.mass_damper_spring;
  const ContactFit& curved = found.hunt_crossley;
  if (!linear.is_valid) return linear;
  const double depth = force / linear.stiffness.value;
  const double other = static_penetration(
      {.stiffness = curved.stiffness.value, .exponent = curved.exponent.value}, force);
  linear.penetration_std = std::hypot(linear.penetration_std, other / depth - 1.0);
  linear.stiffness.std = linear.penetration_std * linear.stiffness.value;
  return linear;
}

/// What a push's own slides say of Coulomb friction: the median force along the push. With a tenth
/// for inertia and for a force that does not go through the centre; not excited without a slide.
IdentifiedParameter friction_in(const ContactEpisode& contact) {
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
  return coulomb_of(median(std::move(forces)), path / duration, kForceError);
}

/// Whether the tip slides along an inclined face, as in an oblique hole: a press under which the
/// object moves, or a contact whose force is neither upright nor level. Neither the tip's path nor
/// the force along it is then that of the contact, or of the support's friction.
bool is_oblique(const ContactRecord& record, const ContactEpisode& contact,
                const ObjectLearner::ContactFacts& facts) {
  constexpr double kMaxTangent = 0.3;  // 17 degrees: level and upright faces give less
  const bool is_press = contact.kind == ContactKind::press;
  if (is_press && (facts.has_moved || facts.has_slid)) return true;
  double vertical = 0.0, horizontal = 0.0;
  for (std::size_t i = 0; i < record.t_force.size(); ++i) {
    if (record.t_force[i] < contact.begin || record.t_force[i] > contact.end) continue;
    vertical += record.force_base[i].z() * record.force_base[i].z();
    horizontal += record.force_base[i].head<2>().squaredNorm();
  }
  const double along = is_press ? vertical : horizontal;
  const double across = is_press ? horizontal : vertical;
  return across > kMaxTangent * kMaxTangent * along;
}

}  // namespace

ObjectLearner::ObjectLearner(const ObjectParameters& given, const LearningOptions& options,
                             bool is_movable)
    : options_(options), is_movable_(is_movable), known_(given), given_(given) {}

bool ObjectLearner::learn(const ContactRecord& record, double begin, const ContactFacts& facts) {
  has_changed_ = false;
  contradiction_.reset();
  const Segmentation found = segment_contacts(record.t_force, record.force_base, record.t_tool,
                                              record.p_base_tip, options_.segmentation);
  const auto nearest = std::min_element(
      found.contacts.begin(), found.contacts.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.begin - begin) < std::abs(b.begin - begin);
      });
  // Empty: the tool was not recorded meanwhile.
  if (nearest == found.contacts.end() || nearest->t.empty() || nearest->impact) return false;
  if (force_ceiling_ && nearest->peak_force >= kSaturatedRatio * *force_ceiling_) return false;
  if (facts.has_moved && !facts.has_slid && !is_press(*nearest)) return false;
  if (is_movable_ && is_oblique(record, *nearest, facts)) return false;
  const bool is_same =
      !contacts_.empty() && std::abs(contacts_.back().begin - nearest->begin) < kSameContact;
  if (!is_same) contacts_.emplace_back();
  if (contacts_.size() > kMaxStoredContacts) contacts_.erase(contacts_.begin());
  contacts_.back() = *nearest;
  if (is_press(contacts_.back())) align_press(record, contacts_.back());
  learn_contact();
  if (!is_press(*nearest) && facts.has_slid) {
    learn_breakaway();
    learn_sliding();
    if (record.seen) learn_turning(record, found, facts.is_over);
  }
  return has_changed_;
}

void ObjectLearner::raise_static_limit(double friction) {
  // Breakaways have shown the limit: what exceeds it is the inertia of a fast push, which is
  // detected late as a slide.
  if (known_.limiting_static_friction && !given_.limiting_static_friction) return;
  conservative_limit_ =
      std::max(conservative_limit_.value_or(0.0), options_.static_limit_factor * friction);
  for (ObjectParameters* parameters : {&known_, &given_}) {
    parameters->limiting_static_friction.reset();
    parameters->sliding_friction_coefficient.reset();
    parameters->viscous_friction.reset();
  }
}

ObjectParameters ObjectLearner::conservative_estimate() const {
  ObjectParameters estimate = known_;
  if (conservative_limit_ && !estimate.limiting_static_friction) {
    estimate.limiting_static_friction = ParameterValue{*conservative_limit_};
  }
  return estimate;
}

void ObjectLearner::align_press(const ContactRecord& record, ContactEpisode& press) const {
  const auto known =
      std::find_if(contacts_.begin(), contacts_.end(), [&](const ContactEpisode& contact) {
        return &contact != &press && is_press(contact) &&
               contact.direction_base.dot(press.direction_base) > kSamePressDirection;
      });
  if (known == contacts_.end()) return;
  press.direction_base = known->direction_base;
  const PathView tip(record.t_tool, record.p_base_tip);
  for (std::size_t i = 0; i < press.t.size(); ++i) {
    press.tool[i] = tip.at(press.t[i]).dot(press.direction_base);
  }
}

bool ObjectLearner::is_press(const ContactEpisode& contact) const {
  return !is_movable_ || contact.kind == ContactKind::press;
}

bool ObjectLearner::is_contradicted(const std::optional<ParameterValue>& old,
                                    const ParameterValue& found) const {
  if (!old) return true;
  const double gap = std::abs(found.value - old->value);
  const double old_std = old->std.value_or(options_.default_relative_std * std::abs(old->value));
  return gap > options_.contradiction_stds * std::hypot(old_std, found.std.value_or(0.0)) &&
         gap > options_.model_error * std::abs(found.value);
}

bool ObjectLearner::accept(std::optional<ParameterValue> ObjectParameters::*field,
                           const ParameterValue& found) {
  std::optional<ParameterValue>& old = known_.*field;
  const bool was_given = (given_.*field).has_value();
  const bool is_more_certain =
      old && old->std && !was_given && found.std.value_or(0.0) <= kMaxStdRatio * *old->std;
  if (!is_more_certain && !is_contradicted(old, found)) return false;
  old = found;
  (given_.*field).reset();
  has_changed_ = true;
  return true;
}

double ObjectLearner::extrapolation_std(const ContactFit& fit,
                                        std::span<const ForceMotion> parts) const {
  if (!known_.limiting_static_friction) return 0.0;
  double max_force = 0.0;
  for (const ForceMotion& part : parts) {
    max_force = std::max(max_force, *std::max_element(part.force.begin(), part.force.end()));
  }
  const double force = known_.limiting_static_friction->value;
  if (!(max_force > 0.0) || force <= max_force) return 0.0;
  // Of d = (F / K)^(1/n), scaled from the largest force that was seen: d ln d / dn.
  const double n = fit.exponent.value;
  return std::log(force / max_force) / (n * n) * std::max(fit.exponent.std, kExponentModelStd);
}

std::optional<double> ObjectLearner::usable_std(const ContactFit& fit,
                                                std::span<const ForceMotion> parts) const {
  if (!fit.is_valid || fit.relative_error > options_.max_fit_error) return std::nullopt;
  // The three parameters are correlated: compared by the penetration that they predict.
  const double relative_std = std::hypot(fit.penetration_std, extrapolation_std(fit, parts));
  if (relative_std > options_.max_penetration_std) return std::nullopt;
  return relative_std;
}

void ObjectLearner::learn_contact() {
  std::vector<ForceMotion> presses, static_parts;
  for (const ContactEpisode& contact : contacts_) {
    const ForceMotion part =
        is_press(contact) ? contact.series() : part_until(contact, static_until(contact));
    if (contact.peak_force < options_.min_peak_force || part.t.size() < kMinContactSamples)
      continue;
    (is_press(contact) ? presses : static_parts).push_back(part);
  }
  for (std::vector<ForceMotion>* parts : {&presses, &static_parts}) {
    if (std::ssize(*parts) > options_.max_fitted_contacts)
      parts->erase(parts->begin(), parts->end() - options_.max_fitted_contacts);
  }
  const bool has_presses = !presses.empty();
  if (!has_presses && static_parts.empty()) return;
  ContactFitOptions options = options_.contact_fit;
  options.is_surface_shared = has_presses;
  const ContactIdentification identified =
      identify_contact(has_presses ? presses : static_parts, options);
  const std::optional<HuntCrossley> old = contact_law_of(known_);
  const std::vector<ForceMotion>& parts = has_presses ? presses : static_parts;
  ContactFit fit = identified.best();
  std::optional<double> std_of_fit = usable_std(fit, parts);
  if (!std_of_fit && !old && has_presses && identified.hunt_crossley.is_valid) {
    fit = preliminary_law(identified, contacts_.back().peak_force);
    std_of_fit = usable_std(fit, parts);
  }
  if (!std_of_fit) return;
  const double relative_std = *std_of_fit;
  if (old && given_.contact_stiffness) {
    const double force = contacts_.back().peak_force;
    const double penetration = static_penetration(
        {.stiffness = fit.stiffness.value, .exponent = fit.exponent.value}, force);
    const double old_penetration = static_penetration(*old, force);
    const double combined_std = std::hypot(options_.default_relative_std, relative_std);
    if (std::abs(old_penetration - penetration) <
        options_.contradiction_stds * combined_std * penetration)
      return;
  }
  known_.contact_stiffness = value_of(fit.stiffness);
  known_.contact_exponent = value_of(fit.exponent);
  // A single contact's posterior is too narrow for the penetration: with it the positions of the
  // simulated pushes without given parameters are 1 to 2 % worse.
  remove_correlation({"contact.stiffness", "contact.exponent", "contact.damping"}, known_.sources);
  known_.contact_damping.reset();
  if (fit.damping.is_excited && fit.damping.value > 0.0) {
    known_.contact_damping = value_of(fit.damping);
  }
  given_.contact_stiffness.reset();
  has_changed_ = true;
}

void ObjectLearner::learn_breakaway() {
  const std::optional<HuntCrossley> contact_law = contact_law_of(known_);
  std::vector<Breakaway> breakaways;
  double noise = 0.0;
  bool has_inertial_peak = false;
  for (const ContactEpisode& contact : contacts_) {
    if (!contact.breakaway.is_found || contact.slides.empty()) continue;
    Breakaway breakaway = contact.breakaway;
    const IdentifiedParameter sliding = friction_in(contact);
    if (contact_law && known_.mass) {
      const IdentifiedParameter own = limit_of_push(contact.series(), breakaway, *contact_law,
                                                    known_.mass->value, options_.onset);
      if (own.is_excited && own.value > 0.0) {
        breakaway.force = own.value;
        breakaway.std = own.std;
      }
    }
    if (is_inertial_peak(breakaway, sliding)) {
      has_inertial_peak = true;
      continue;
    }
    // A peak of the load before the object slides at all: the tip slipped, or left and came again.
    const double std = std::max(breakaway.std, options_.single_breakaway_std * breakaway.force);
    if (!limit_above_sliding({breakaway.force, std, true}, sliding).is_excited) {
      if (&contact == &contacts_.back()) contradict(breakaway.force, sliding.value);
      withdraw_limit_below(sliding);
      continue;
    }
    noise = std::max(noise, breakaway.std);
    breakaways.push_back(breakaway);
  }
  if (breakaways.empty()) {
    if (has_inertial_peak) discard_learned_limit();
    return;
  }
  const LimitingFriction limit = limiting_friction(breakaways, options_.limiting_friction);
  const double spread = limit.pushes > 1
                            ? std::max(limit.std, noise)
                            : std::max(noise, options_.single_breakaway_std * limit.mean);
  const IdentifiedParameter bounded = limit_above_sliding({limit.mean, spread, true}, coulomb_);
  if (!bounded.is_excited) return contradict(limit.mean, coulomb_.value);
  accept(&ObjectParameters::limiting_static_friction, {bounded.value, spread});
  known_.loading_rate = ParameterValue{limit.loading_rate};
  if (limit.pushes > 1) known_.loading_rate->std = limit.loading_rate_std;
}

void ObjectLearner::contradict(double limit, double sliding) {
  contradiction_ = fmt::format(
      "a breakaway at {:.2f} N is below the sliding friction, {:.2f} N: it is not used to identify",
      limit, sliding);
}

void ObjectLearner::withdraw_limit_below(const IdentifiedParameter& sliding) {
  std::optional<ParameterValue>& limit = known_.limiting_static_friction;
  if (!limit || given_.limiting_static_friction) return;
  const double std = limit->std.value_or(options_.default_relative_std * limit->value);
  if (limit_above_sliding({limit->value, std, true}, sliding).is_excited) return;
  contradict(limit->value, sliding.value);
  discard_learned_limit();
}

void ObjectLearner::discard_learned_limit() {
  std::optional<ParameterValue>& limit = known_.limiting_static_friction;
  if (!limit || given_.limiting_static_friction) return;
  limit.reset();
  has_changed_ = true;
}

void ObjectLearner::learn_sliding() {
  const std::optional<HuntCrossley> identified = contact_law_of(known_);
  // A slide's friction needs the penetration's changes only. An error of theirs appears as mass.
  const std::optional<HuntCrossley>& contact_law = identified ? identified : assumed_law_;
  if (!contact_law || (!identified && !known_.mass)) return;
  std::vector<ForceMotion> pushes;
  for (const ContactEpisode& contact : contacts_) {
    if (!contact.slides.empty()) pushes.push_back(contact.series());
  }
  if (pushes.empty()) return;
  if (std::ssize(pushes) > options_.max_fitted_contacts)
    pushes.erase(pushes.begin(), pushes.end() - options_.max_fitted_contacts);
  SlidingOptions options = options_.sliding;
  if (known_.mass) options.mass = known_.mass->value;
  const SlidingIdentification found = identify_sliding(pushes, *contact_law, options);
  if (!found.is_valid || !found.coulomb.is_excited) return;
  // The slides of few pushes: friction varies by more than their noise.
  coulomb_ = coulomb_of(found.coulomb.value, found.viscous.is_excited ? 0.0 : found.speed,
                        options_.model_error);
  withdraw_limit_below(coulomb_);
  if (found.mass.is_excited && identified) accept(&ObjectParameters::mass, value_of(found.mass));
  if (!known_.mass) return;
  double coulomb = found.coulomb.value;
  if (found.viscous.is_excited && found.viscous.value >= 0.0 && identified) {
    accept(&ObjectParameters::viscous_friction, value_of(found.viscous));
  }
  // The total friction at this speed is known; its split depends on the viscous friction.
  if (found.viscous.is_excited) coulomb += found.viscous.value * found.speed;
  if (known_.viscous_friction) coulomb -= known_.viscous_friction->value * found.speed;
  const double weight = known_.mass->value * options_.sliding.gravity;
  if (coulomb <= 0.0) return;
  accept(&ObjectParameters::sliding_friction_coefficient,
         {coulomb / weight, found.coulomb.std / weight});
}

}  // namespace pcavr
