// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/object_learner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pcavr/contact/compliance.hpp"
#include "pcavr/core/gravity.hpp"
#include "pcavr/identification/contact_fit.hpp"

namespace pcavr {
namespace {

// Relative standard deviation of a parameter without a stated one.
constexpr double kDefaultRelativeStd = 0.05;
// Data contradict a parameter beyond this many standard deviations and this relative model error.
constexpr double kContradiction = 4.0;
constexpr double kModelError = 0.05;
// A new estimate from more data replaces the old one up to this ratio of standard deviations.
constexpr double kMaxStdRatio = 1.2;
// Relative standard deviation of the breakaway force, if only one was observed.
constexpr double kSingleBreakawayStd = 0.03;
// A contact fit with a larger relative force residual is rejected.
constexpr double kMaxFitError = 0.1;
// As is one with a larger relative standard deviation of the penetration.
constexpr double kMaxRelativeStd = 0.25;
// [N] Contacts with less force are not used for the contact law.
constexpr double kMinPeak = 1.0;
// Safety factor of the conservative F_M over the largest force without breakaway.
constexpr double kLimitFactor = 1.5;
// The estimated start of a new contact may still change by this much with more data [s].
constexpr double kSameContact = 0.25;
// Number of newest contacts that are fitted together, which bounds the cost. Estimates from older
// ones are kept until newer ones contradict them.
constexpr std::ptrdiff_t kMaxFittedContacts = 6;
// A standard deviation of breakaways needs more of them.
constexpr std::size_t kMaxStoredContacts = 20;

ParameterValue value_of(const IdentifiedParameter& parameter) {
  return {parameter.value, parameter.std};
}

/// End of the static phase: the breakaway alarm, at the latest the first slide.
double static_until(const ContactEpisode& contact) {
  if (contact.kind == ContactKind::press) return contact.t.back();
  double until = contact.t.back();
  if (contact.breakaway.t_alarm > 0.0) until = std::min(until, contact.breakaway.t_alarm);
  if (!contact.slides.empty()) until = std::min(until, contact.slides.front().begin);
  return until;
}

ForceMotion part_until(const ContactEpisode& contact, double until) {
  const auto end = std::upper_bound(contact.t.begin(), contact.t.end(), until);
  const auto count = static_cast<std::size_t>(end - contact.t.begin());
  return {std::span(contact.t).first(count), std::span(contact.tool).first(count),
          std::span(contact.force).first(count)};
}

}  // namespace

ObjectLearner::ObjectLearner(const ObjectParameters& given, std::optional<double> force_ceiling)
    : known_(given), given_(given), force_ceiling_(force_ceiling) {}

bool ObjectLearner::learn(const ContactRecord& record, double begin, bool has_slid) {
  has_changed_ = false;
  const Segmentation found =
      segment_contacts(record.t_force, record.force_base, record.t_tool, record.p_base_tip);
  const auto nearest = std::min_element(
      found.contacts.begin(), found.contacts.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.begin - begin) < std::abs(b.begin - begin);
      });
  // Empty: the tool was not recorded meanwhile.
  if (nearest == found.contacts.end() || nearest->t.empty()) return false;
  if (force_ceiling_ && nearest->peak_force >= 0.98 * *force_ceiling_) return false;
  const bool is_same =
      !contacts_.empty() && std::abs(contacts_.back().begin - nearest->begin) < kSameContact;
  if (!is_same) contacts_.emplace_back();
  if (contacts_.size() > kMaxStoredContacts) contacts_.erase(contacts_.begin());
  contacts_.back() = *nearest;
  learn_contact();
  if (nearest->kind != ContactKind::press && has_slid) {
    learn_breakaway();
    learn_sliding();
  }
  return has_changed_;
}

void ObjectLearner::raise_static_limit(double friction) {
  conservative_limit_ = std::max(conservative_limit_.value_or(0.0), kLimitFactor * friction);
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

bool ObjectLearner::is_contradicted(const std::optional<ParameterValue>& old,
                                    const ParameterValue& found) const {
  if (!old) return true;
  const double gap = std::abs(found.value - old->value);
  const double old_std = old->std.value_or(kDefaultRelativeStd * std::abs(old->value));
  return gap > kContradiction * std::hypot(old_std, found.std.value_or(0.0)) &&
         gap > kModelError * std::abs(found.value);
}

void ObjectLearner::accept(std::optional<ParameterValue> ObjectParameters::*field,
                           const ParameterValue& found) {
  std::optional<ParameterValue>& old = known_.*field;
  const bool was_given = (given_.*field).has_value();
  const bool is_more_certain =
      old && old->std && !was_given && found.std.value_or(0.0) <= kMaxStdRatio * *old->std;
  if (!is_more_certain && !is_contradicted(old, found)) return;
  old = found;
  (given_.*field).reset();
  has_changed_ = true;
}

void ObjectLearner::learn_contact() {
  std::vector<ForceMotion> presses, static_parts;
  for (const ContactEpisode& contact : contacts_) {
    const ForceMotion part = part_until(contact, static_until(contact));
    if (contact.peak_force < kMinPeak || part.t.size() < 30) continue;
    (contact.kind == ContactKind::press ? presses : static_parts).push_back(part);
  }
  for (std::vector<ForceMotion>* parts : {&presses, &static_parts}) {
    if (std::ssize(*parts) > kMaxFittedContacts)
      parts->erase(parts->begin(), parts->end() - kMaxFittedContacts);
  }
  const bool has_presses = !presses.empty();
  if (!has_presses && static_parts.empty()) return;
  const ContactIdentification identified =
      has_presses ? identify_contact(presses)
                  : identify_contact(static_parts, {.is_surface_shared = false});
  const ContactFit& fit = identified.best();
  if (!fit.is_valid || !fit.stiffness.is_excited || fit.relative_error > kMaxFitError) return;
  // The three parameters are correlated: compared by the penetration that they predict.
  const double relative_std = fit.stiffness.std / fit.stiffness.value / fit.exponent.value;
  if (relative_std > kMaxRelativeStd) return;
  const std::optional<Compliance> old = compliance_of(known_);
  if (old && given_.contact_stiffness) {
    const double force = contacts_.back().peak_force;
    const double penetration = static_penetration(
        {.stiffness = fit.stiffness.value, .exponent = fit.exponent.value}, force);
    const double old_penetration = static_penetration(*old, force);
    const double combined_std = std::hypot(kDefaultRelativeStd, relative_std);
    if (std::abs(old_penetration - penetration) < kContradiction * combined_std * penetration)
      return;
  }
  known_.contact_stiffness = value_of(fit.stiffness);
  known_.contact_exponent = value_of(fit.exponent);
  known_.contact_damping.reset();
  if (fit.damping.is_excited && fit.damping.value > 0.0) {
    known_.contact_damping = value_of(fit.damping);
  }
  given_.contact_stiffness.reset();
  has_changed_ = true;
}

void ObjectLearner::learn_breakaway() {
  const std::optional<Compliance> compliance = compliance_of(known_);
  std::vector<Breakaway> breakaways;
  double noise = 0.0;
  for (const ContactEpisode& contact : contacts_) {
    if (!contact.breakaway.is_found || contact.slides.empty()) continue;
    Breakaway breakaway = contact.breakaway;
    if (compliance && known_.mass) {
      const IdentifiedParameter own =
          limit_of_push(contact.series(), breakaway, *compliance, known_.mass->value);
      if (own.is_excited && own.value > 0.0) {
        breakaway.force = own.value;
        breakaway.std = own.std;
      }
    }
    noise = std::max(noise, breakaway.std);
    breakaways.push_back(breakaway);
  }
  if (breakaways.empty()) return;
  const LimitingFriction limit = limiting_friction(breakaways);
  const double spread = limit.pushes > 1 ? std::max(limit.std, noise)
                                         : std::max(noise, kSingleBreakawayStd * limit.mean);
  accept(&ObjectParameters::limiting_static_friction, {limit.mean, spread});
  known_.loading_rate = ParameterValue{limit.loading_rate};
  if (limit.pushes > 1) known_.loading_rate->std = limit.loading_rate_std;
}

void ObjectLearner::learn_sliding() {
  const std::optional<Compliance> compliance = compliance_of(known_);
  if (!compliance) return;
  std::vector<ForceMotion> pushes;
  for (const ContactEpisode& contact : contacts_) {
    if (!contact.slides.empty()) pushes.push_back(contact.series());
  }
  if (pushes.empty()) return;
  if (std::ssize(pushes) > kMaxFittedContacts)
    pushes.erase(pushes.begin(), pushes.end() - kMaxFittedContacts);
  SlidingOptions options;
  if (known_.mass) options.mass = known_.mass->value;
  const SlidingIdentification found = identify_sliding(pushes, *compliance, options);
  if (!found.is_valid || !found.coulomb.is_excited) return;
  if (found.mass.is_excited) accept(&ObjectParameters::mass, value_of(found.mass));
  if (!known_.mass) return;
  double coulomb = found.coulomb.value;
  if (found.viscous.is_excited && found.viscous.value >= 0.0) {
    accept(&ObjectParameters::viscous_friction, value_of(found.viscous));
  }
  // The total friction at this speed is known; its split depends on the viscous friction.
  if (found.viscous.is_excited) coulomb += found.viscous.value * found.speed;
  if (known_.viscous_friction) coulomb -= known_.viscous_friction->value * found.speed;
  const double weight = known_.mass->value * kStandardGravity;
  if (coulomb <= 0.0) return;
  accept(&ObjectParameters::sliding_friction_coefficient,
         {coulomb / weight, found.coulomb.std / weight});
}

}  // namespace pcavr
