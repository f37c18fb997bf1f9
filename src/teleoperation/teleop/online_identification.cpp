// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/online_identification.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/path_view.hpp"

namespace pcavr {
namespace {

// A peak this near to the force at which the sensor saturates is cut off.
constexpr double kSaturatedRatio = 0.98;
// [samples] Fewer do not determine the contact law's three parameters.
constexpr std::size_t kMinContactSamples = 30;
// Cosine between the mean forces of two presses on the same face: 1 degree, of noise and friction.
constexpr double kSamePressDirection = 0.9998;
// Std of the exponent that holds beyond the forces that were seen: a third of what laws range over.
constexpr double kExponentModelStd = 0.25;
// More than are fitted together: some are too weak to be.
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

double largest_force(std::span<const ForceMotion> parts) {
  double force = 0.0;
  for (const ForceMotion& part : parts)
    force = std::max(force, *std::max_element(part.force.begin(), part.force.end()));
  return force;
}

/// The linear law of a young contact, whose force has not risen far enough to show an exponent:
/// with one parameter less it is known sooner. The other law's difference in penetration at `force`
/// [N] is part of its std.
ContactFit preliminary_law(const ContactIdentification& found, double force) {
  ContactFit linear = found.mass_damper_spring;
  if (!linear.is_valid) return linear;
  linear.penetration_std = std::hypot(linear.penetration_std, curvature_std(found, linear, force));
  linear.stiffness.std = linear.penetration_std * linear.stiffness.value;
  return linear;
}

/// Whether the tip slides along an inclined face, as in an oblique hole: a press under which the
/// object moves, or a contact whose force is neither upright nor level. Neither the tip's path nor
/// the force along it is then that of the contact, or of the support's friction.
bool is_oblique(const ContactRecord& record, const ContactEpisode& contact,
                const OnlineIdentification::ContactFacts& facts) {
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

OnlineIdentification::OnlineIdentification(const ObjectParameters& given,
                                           const LearningOptions& options, bool is_movable)
    : options_(options), is_movable_(is_movable), known_(given), given_(given) {}

bool OnlineIdentification::learn(const ContactRecord& record, double begin,
                                 const ContactFacts& facts) {
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
  if (is_press(*nearest)) {
    align_press(record, contacts_.back());
    learn_contact();
    return has_changed_;
  }
  IdentifiedContact contact = attributed(record, found);
  contacts_.back() = contact.episode;
  learn_contact();
  if (!facts.has_slid) return has_changed_;
  check_limits(contact);
  assume_friction(contact.episode);
  store_push(record, contact);
  if (record.seen) learn_turning(record, contact, facts.is_over);
  return has_changed_;
}

void OnlineIdentification::raise_static_limit(double friction) {
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

ObjectParameters OnlineIdentification::conservative_estimate() const {
  ObjectParameters estimate = known_;
  if (conservative_limit_ && !estimate.limiting_static_friction) {
    estimate.limiting_static_friction = ParameterValue{*conservative_limit_};
  }
  return estimate;
}

void OnlineIdentification::align_press(const ContactRecord& record, ContactEpisode& press) const {
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

bool OnlineIdentification::is_press(const ContactEpisode& contact) const {
  return !is_movable_ || contact.kind == ContactKind::press;
}

bool OnlineIdentification::is_contradicted(const std::optional<ParameterValue>& old,
                                           const ParameterValue& found) const {
  if (!old) return true;
  const double gap = std::abs(found.value - old->value);
  const double old_std = old->std.value_or(options_.default_relative_std * std::abs(old->value));
  return gap > options_.contradiction_stds * std::hypot(old_std, found.std.value_or(0.0)) &&
         gap > options_.model_error * std::abs(found.value);
}

bool OnlineIdentification::accept(std::optional<ParameterValue> ObjectParameters::*field,
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

double OnlineIdentification::extrapolation_std(const ContactFit& fit,
                                               std::span<const ForceMotion> parts) const {
  if (!known_.limiting_static_friction) return 0.0;
  const double max_force = largest_force(parts);
  const double force = known_.limiting_static_friction->value;
  if (!(max_force > 0.0) || force <= max_force) return 0.0;
  // Relative std of d = (F / K)^(1/n), scaled from the largest force that was seen: d ln d / dn.
  const double n = fit.exponent.value;
  return std::log(force / max_force) / (n * n) * std::max(fit.exponent.std, kExponentModelStd);
}

std::optional<double> OnlineIdentification::usable_std(const ContactFit& fit,
                                                       std::span<const ForceMotion> parts) const {
  if (!fit.is_valid || fit.relative_error > options_.max_fit_error) return std::nullopt;
  // The three parameters are correlated: compared by the penetration that they predict.
  const double relative_std = std::hypot(fit.penetration_std, extrapolation_std(fit, parts));
  if (relative_std > options_.max_penetration_std) return std::nullopt;
  return relative_std;
}

void OnlineIdentification::learn_contact() {
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
  if (has_presses && identified.best().is_valid) presses_ = identified;
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
  penetration_std_ =
      std::hypot(fit.penetration_std, curvature_std(identified, fit, largest_force(parts)));
  known_.contact_stiffness = value_of(fit.stiffness);
  known_.contact_exponent = value_of(fit.exponent);
  // A single contact's posterior is too narrow for the penetration: with it the positions of the
  // simulated pushes without given parameters are 1 to 2 % worse.
  remove_correlation({"contact.stiffness", "contact.exponent", "contact.damping"}, known_.sources);
  known_.contact_damping.reset();
  // Damping is kept as by `pcavr identify`; of pushes, which creep, only if it is identified.
  if (has_presses || (fit.damping.is_excited && fit.damping.value > 0.0)) {
    known_.contact_damping = damping_of(fit);
  }
  given_.contact_stiffness.reset();
  has_changed_ = true;
}

}  // namespace pcavr
