// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/object_learner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pcavr/core/gravity.hpp"
#include "pcavr/identification/contact_fit.hpp"

namespace pcavr {
namespace {

// A number of which nobody said how sure it is [share].
constexpr double kUnstatedDeviation = 0.05;
// From where data speak against a number: chance, and what the models themselves are off by.
constexpr double kContradiction = 4.0;
constexpr double kModelShare = 0.05;
// A new estimate from more data may be this much less sure than the old one and still replace it.
constexpr double kWorse = 1.2;
// Spread of breakaways that a single one leaves open [share].
constexpr double kOneBreakaway = 0.03;
// A contact fit that misses the force by more is no law [share].
constexpr double kLawError = 0.1;
// A fit that does not know a depth any better than this is no law either [share].
constexpr double kUnsure = 0.25;
// Less force shows no law [N].
constexpr double kMinPeak = 1.0;
// Over what an object has withstood: the next newton must not be its last.
constexpr double kRougher = 1.5;
// Of a contact that has just begun, the begin may still move by this much as more is seen [s].
constexpr double kSameContact = 0.25;
// Contacts that are learned from together: work must not grow with what was recorded. What older
// ones told stays known until newer ones contradict it.
constexpr std::ptrdiff_t kNewest = 6;
// A spread wants more of them.
constexpr std::size_t kRemembered = 20;

ParameterValue value_of(const IdentifiedParameter& parameter) {
  return {parameter.value, parameter.deviation};
}

/// Until when the object stood: the alarm, and nothing after a slide.
double standing_until(const ContactEpisode& contact) {
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
  if (contacts_.size() > kRemembered) contacts_.erase(contacts_.begin());
  contacts_.back() = *nearest;
  learn_contact();
  if (nearest->kind != ContactKind::press && has_slid) {
    learn_breakaway();
    learn_sliding();
  }
  return has_changed_;
}

void ObjectLearner::withstand(double friction) {
  supposed_limit_ = std::max(supposed_limit_.value_or(0.0), kRougher * friction);
  for (ObjectParameters* parameters : {&known_, &given_}) {
    parameters->limiting_static_friction.reset();
    parameters->sliding_friction_coefficient.reset();
    parameters->viscous_friction.reset();
  }
}

ObjectParameters ObjectLearner::supposed() const {
  ObjectParameters supposed = known_;
  if (supposed_limit_ && !supposed.limiting_static_friction) {
    supposed.limiting_static_friction = ParameterValue{*supposed_limit_};
  }
  return supposed;
}

bool ObjectLearner::is_contradicted(const std::optional<ParameterValue>& old,
                                    const ParameterValue& found) const {
  if (!old) return true;
  const double gap = std::abs(found.value - old->value);
  const double old_deviation = old->deviation.value_or(kUnstatedDeviation * std::abs(old->value));
  return gap > kContradiction * std::hypot(old_deviation, found.deviation.value_or(0.0)) &&
         gap > kModelShare * std::abs(found.value);
}

void ObjectLearner::accept(std::optional<ParameterValue> ObjectParameters::*field,
                           const ParameterValue& found) {
  std::optional<ParameterValue>& old = known_.*field;
  const bool was_given = (given_.*field).has_value();
  const bool is_surer = old && old->deviation && !was_given &&
                        found.deviation.value_or(0.0) <= kWorse * *old->deviation;
  if (!is_surer && !is_contradicted(old, found)) return;
  old = found;
  (given_.*field).reset();
  has_changed_ = true;
}

void ObjectLearner::learn_contact() {
  std::vector<ForceMotion> presses, standing;
  for (const ContactEpisode& contact : contacts_) {
    const ForceMotion part = part_until(contact, standing_until(contact));
    if (contact.peak_force < kMinPeak || part.t.size() < 30) continue;
    (contact.kind == ContactKind::press ? presses : standing).push_back(part);
  }
  for (std::vector<ForceMotion>* parts : {&presses, &standing}) {
    if (std::ssize(*parts) > kNewest) parts->erase(parts->begin(), parts->end() - kNewest);
  }
  const bool has_presses = !presses.empty();
  if (!has_presses && standing.empty()) return;
  const ContactIdentification identified =
      has_presses ? identify_contact(presses)
                  : identify_contact(standing, {.is_surface_shared = false});
  const ContactFit& fit = identified.best();
  if (!fit.is_valid || !fit.stiffness.is_excited || fit.relative_error > kLawError) return;
  // The three numbers belong together; what counts is how deep they let the tip in.
  const double unsure = fit.stiffness.deviation / fit.stiffness.value / fit.exponent.value;
  if (unsure > kUnsure) return;
  const std::optional<Compliance> old = compliance_of(known_);
  if (old && given_.contact_stiffness) {
    const double force = contacts_.back().peak_force;
    const double depth = std::pow(force / fit.stiffness.value, 1.0 / fit.exponent.value);
    const double old_depth = std::pow(force / old->stiffness, 1.0 / old->exponent);
    const double deviation = std::hypot(kUnstatedDeviation, unsure);
    if (std::abs(old_depth - depth) < kContradiction * deviation * depth) return;
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
        breakaway.deviation = own.deviation;
      }
    }
    noise = std::max(noise, breakaway.deviation);
    breakaways.push_back(breakaway);
  }
  if (breakaways.empty()) return;
  const LimitingFriction limit = limiting_friction(breakaways);
  const double spread = limit.pushes > 1 ? std::max(limit.deviation, noise)
                                         : std::max(noise, kOneBreakaway * limit.mean);
  accept(&ObjectParameters::limiting_static_friction, {limit.mean, spread});
  known_.loading_rate = ParameterValue{limit.loading_rate};
  if (limit.pushes > 1) known_.loading_rate->deviation = limit.loading_rate_deviation;
}

void ObjectLearner::learn_sliding() {
  const std::optional<Compliance> compliance = compliance_of(known_);
  if (!compliance) return;
  std::vector<ForceMotion> pushes;
  for (const ContactEpisode& contact : contacts_) {
    if (!contact.slides.empty()) pushes.push_back(contact.series());
  }
  if (pushes.empty()) return;
  if (std::ssize(pushes) > kNewest) pushes.erase(pushes.begin(), pushes.end() - kNewest);
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
  // What is carried at this speed is known; how it splits is the viscous friction's business.
  if (found.viscous.is_excited) coulomb += found.viscous.value * found.speed;
  if (known_.viscous_friction) coulomb -= known_.viscous_friction->value * found.speed;
  const double weight = known_.mass->value * kStandardGravity;
  if (coulomb <= 0.0) return;
  accept(&ObjectParameters::sliding_friction_coefficient,
         {coulomb / weight, found.coulomb.deviation / weight});
}

}  // namespace pcavr
