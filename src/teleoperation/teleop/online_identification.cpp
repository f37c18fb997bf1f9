// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Online identification: the contacts, and their contact law.
#include "teleoperation/teleop/online_identification.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/align_with_face.hpp"

namespace pcavr {
namespace {

// [s] The estimated start of a new contact may still change by this much with more data.
constexpr double kSameContact = 0.25;
// A peak this near to the force at which the sensor saturates is cut off.
constexpr double kSaturatedRatio = 0.98;
// [samples] Fewer do not determine the contact law's three parameters.
constexpr std::size_t kMinContactSamples = 30;
// Std of the exponent that holds beyond the forces that were seen: a third of what laws range over.
constexpr double kExponentModelStd = 0.25;

IdentificationOptions identification_options(const LearningOptions& learning) {
  IdentificationOptions options;
  options.inputs.segmentation = learning.segmentation;
  options.contact_fit = learning.contact_fit;
  options.onset = learning.onset;
  options.limiting_friction = learning.limiting_friction;
  options.sliding = learning.sliding;
  options.friction_priors = learning.friction_priors;
  options.breakaway_priors = learning.breakaway_priors;
  options.limit_surface = learning.limit_surface;
  options.compares_estimators = false;
  return options;
}

void forget_law(ObjectParameters& parameters) {
  parameters.contact_stiffness.reset();
  parameters.contact_damping.reset();
  parameters.contact_exponent.reset();
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

HuntCrossley law_of(const ContactFit& fit) {
  return {.stiffness = fit.stiffness.value, .exponent = fit.exponent.value};
}

/// Whether the tip slides along an inclined face, as in an oblique hole: a press under which the
/// object moves, or a contact whose force is neither upright nor level. Neither the tip's path nor
/// the force along it is then that of the contact, or of the support's friction.
bool is_oblique(const ContactSamples& samples, const Contact& contact) {
  constexpr double kMaxTangent = 0.3;  // 17 degrees: level and upright faces give less
  const bool is_press = contact.kind == ContactKind::press;
  if (is_press && (samples.facts.has_moved || samples.facts.has_slid)) return true;
  double vertical = 0.0, horizontal = 0.0;
  for (std::size_t i = 0; i < samples.t_force.size(); ++i) {
    if (samples.t_force[i] < contact.begin || samples.t_force[i] > contact.end) continue;
    vertical += samples.force_base[i].z() * samples.force_base[i].z();
    horizontal += samples.force_base[i].head<2>().squaredNorm();
  }
  const double along = is_press ? vertical : horizontal;
  const double across = is_press ? horizontal : vertical;
  return across > kMaxTangent * kMaxTangent * along;
}

}  // namespace

OnlineIdentification::OnlineIdentification(std::shared_ptr<const IdentifiableObject> object,
                                           const ObjectParameters& given, double tool_radius,
                                           const LearningOptions& options)
    : options_(options),
      object_(std::move(object)),
      identifier_(*object_, {}, tool_radius, IdentificationGoal::friction,
                  identification_options(options)),
      tool_radius_(tool_radius),
      known_(given),
      given_(given) {}

bool OnlineIdentification::learn(const ContactSamples& samples) {
  has_changed_ = false;
  contradiction_.reset();
  Segmentation found = segment_contacts(samples.t_force, samples.force_base, samples.t_tool,
                                        samples.p_base_tip, options_.segmentation);
  const auto nearest = std::min_element(
      found.contacts.begin(), found.contacts.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.begin - samples.begin) < std::abs(b.begin - samples.begin);
      });
  if (nearest == found.contacts.end() || !is_usable(*nearest, samples)) return false;
  if (samples.facts.has_slid && !is_press(*nearest)) check_breakaway(*nearest);
  auto contact = along_face(samples, std::move(*nearest));
  if (!contact->t_tool.empty()) store(std::move(contact), samples.facts.has_slid);
  return has_changed_;
}

bool OnlineIdentification::add(std::shared_ptr<const Contact> contact, bool has_slid) {
  has_changed_ = false;
  store(std::move(contact), has_slid);
  return has_changed_;
}

void OnlineIdentification::store(std::shared_ptr<const Contact> contact, bool has_slid) {
  if (!contacts_.empty() && std::abs(contacts_.back()->begin - contact->begin) < kSameContact)
    contacts_.pop_back();
  contacts_.push_back(contact);
  forget_old_contacts();
  // A press that goes on as a push is no press any more.
  is_law_of_presses_ &=
      std::ranges::any_of(contacts_, [this](const auto& one) { return is_press(*one); });
  const bool shows_friction = has_slid && !is_press(*contact);
  has_slid_ = has_slid_ || shows_friction;
  is_search_due_ = has_slid_;
  learn_contact();
  if (shows_friction) assume_friction(*contact);
}

bool OnlineIdentification::is_usable(const Contact& contact, const ContactSamples& samples) const {
  // Empty: the tool was not recorded meanwhile.
  if (contact.t.empty() || contact.impact) return false;
  if (force_ceiling_ && contact.peak_force >= kSaturatedRatio * *force_ceiling_) return false;
  const bool shows_law =
      contact.peak_force >= options_.min_peak_force && contact.t.size() >= kMinContactSamples;
  if (!shows_law && (is_press(contact) || !samples.facts.has_slid)) return false;
  if (samples.facts.has_moved && !samples.facts.has_slid && !is_press(contact)) return false;
  return !object_->is_movable || !is_oblique(samples, contact);
}

double OnlineIdentification::path_end_before(double begin) const {
  const auto before = std::find_if(contacts_.rbegin(), contacts_.rend(), [&](const auto& contact) {
    return std::abs(contact->begin - begin) >= kSameContact;
  });
  return before == contacts_.rend() ? -std::numeric_limits<double>::infinity()
                                    : (*before)->t_tool.back();
}

std::shared_ptr<const Contact> OnlineIdentification::along_face(const ContactSamples& samples,
                                                                Contact&& contact) const {
  const double from = path_end_before(contact.begin);
  const auto first = std::upper_bound(samples.t_tool.begin(), samples.t_tool.end(), from);
  contact.t_tool.assign(first, samples.t_tool.end());
  contact.p_base_tip.assign(samples.p_base_tip.begin() + (first - samples.t_tool.begin()),
                            samples.p_base_tip.end());
  std::copy_if(samples.tracked.begin(), samples.tracked.end(), std::back_inserter(contact.tracked),
               [from](const TrackedPose& pose) { return pose.t > from; });
  contact.object = 0;
  if (!samples.facts.has_slid) {
    contact.breakaway.is_found = false;
    contact.slides.clear();
    if (contact.kind == ContactKind::slide) contact.kind = ContactKind::push;
  }
  const PathView tip(samples.t_tool, samples.p_base_tip);
  const bool is_tracked = !samples.tracked.empty();
  contact.T_base_object =
      is_tracked ? pose_at(samples.tracked, contact.begin) : object_->T_base_object;
  // Of an object that may be anywhere, the contacts along one direction are on one face.
  contact.normal_object =
      is_tracked
          ? identifier_.surface()
                .touch(contact.T_base_object, tip.at(contact.begin), tool_radius_)
                .normal_object
          : Eigen::Vector3d(contact.T_base_object.rotation().inverse() * -contact.direction_base);
  std::vector<Eigen::Vector3d> directions_base;
  for (const auto& other : contacts_) {
    if (std::abs(other->begin - contact.begin) >= kSameContact)
      directions_base.push_back(other->direction_base);
  }
  align_with_face(object_->model.centre_of_mass_object, tip, directions_base, contact);
  if (!is_tracked) contact.lever = 0.0;
  return std::make_shared<const Contact>(std::move(contact));
}

void OnlineIdentification::forget_old_contacts() {
  const bool presses = is_press(*contacts_.back());
  const auto is_same_kind = [&](const auto& contact) { return is_press(*contact) == presses; };
  if (std::ranges::count_if(contacts_, is_same_kind) > options_.max_fitted_contacts)
    contacts_.erase(std::ranges::find_if(contacts_, is_same_kind));
}

ObjectIdentifier OnlineIdentification::identifier(const ObjectParameters& known,
                                                  IdentificationGoal goal) const {
  ObjectIdentifier identifier = identifier_.with(known, goal);
  for (const auto& contact : contacts_) identifier.add(contact);
  return identifier;
}

void OnlineIdentification::set_suspected_turn(double angle) {
  if (angle == suspected_turn_) return;
  suspected_turn_ = angle;
  identifier_.set_suspected_turn(angle);
  is_search_due_ = has_slid_;
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

bool OnlineIdentification::is_press(const Contact& contact) const {
  return !object_->is_movable || contact.kind == ContactKind::press;
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

std::optional<double> OnlineIdentification::usable_std(const ContactFit& fit, bool is_of_face,
                                                       double max_force) const {
  if (!fit.is_valid || fit.relative_error > options_.max_fit_error) return std::nullopt;
  // A law of the first newtons says little about the tenfold: d ln d / dn of d = (F / K)^(1/n),
  // scaled from the largest force that was seen.
  double beyond = 0.0;
  if (known_.limiting_static_friction && max_force > 0.0) {
    const double n = fit.exponent.value;
    beyond = std::max(0.0, std::log(known_.limiting_static_friction->value / max_force)) / (n * n) *
             std::max(fit.exponent.std, kExponentModelStd);
  }
  // The three parameters are correlated: compared by the penetration that they predict.
  const double relative_std = std::hypot(fit.penetration_std, beyond);
  // A face's std is mostly that of its assumed exponent; FaceContact::is_usable limits it.
  if ((is_of_face ? beyond : relative_std) > options_.max_penetration_std) return std::nullopt;
  return relative_std;
}

bool OnlineIdentification::is_given_law_confirmed(const HuntCrossley& law,
                                                  double relative_std) const {
  const std::optional<HuntCrossley> given = contact_law_of(given_);
  if (!given) return false;
  const double force = contacts_.back()->peak_force;
  const double penetration = static_penetration(law, force);
  const double combined_std = std::hypot(options_.default_relative_std, relative_std);
  return std::abs(static_penetration(*given, force) - penetration) <
         options_.contradiction_stds * combined_std * penetration;
}

ObjectIdentification OnlineIdentification::identify_law() const {
  ObjectParameters without_law = given_;
  forget_law(without_law);
  ObjectIdentifier of_presses = identifier_.with(without_law, IdentificationGoal::contact);
  for (const auto& contact : contacts_) {
    if (is_press(*contact)) of_presses.add(contact);
  }
  if (of_presses.size() > 0) {
    ObjectIdentification found = of_presses.result().object;
    if (found.presses.best().is_valid || of_presses.size() == contacts_.size()) return found;
  }
  return identifier(without_law, IdentificationGoal::contact).result().object;
}

void OnlineIdentification::learn_contact() {
  const bool is_push = !is_press(*contacts_.back());
  if (is_push && is_law_of_presses_) return;  // pushes change nothing in it
  const ObjectIdentification found = identify_law();
  const double max_force = found.penetration.max_force;
  const bool has_presses = found.presses.best().is_valid;
  const FaceContact* face = has_presses ? nullptr : face_of_law(found);
  ContactFit fit = face != nullptr ? face->contact.best() : found.presses.best();
  std::optional<double> std_of_fit = usable_std(fit, face != nullptr, max_force);
  const bool is_preliminary =
      !std_of_fit && !contact_law_of(known_) && found.presses.hunt_crossley.is_valid;
  if (is_preliminary) {
    fit = preliminary_law(found.presses, contacts_.back()->peak_force);
    std_of_fit = usable_std(fit, false, max_force);
  }
  if (!std_of_fit || is_given_law_confirmed(law_of(fit), *std_of_fit)) return;
  if (is_preliminary || !found.parameters.contact_stiffness) {
    // Pushes off the centre give no result, but a law that is nearer than an assumed one.
    known_.contact_stiffness = as_value(fit.stiffness);
    known_.contact_exponent = as_value(fit.exponent);
    known_.contact_damping = has_presses ? damping_of(fit) : std::nullopt;
  } else {
    known_.contact_stiffness = found.parameters.contact_stiffness;
    known_.contact_exponent = found.parameters.contact_exponent;
    known_.contact_damping = found.parameters.contact_damping;
  }
  // A single contact's posterior is too narrow for the penetration: with it the positions of the
  // simulated pushes without given parameters are 1 to 2 % worse.
  remove_correlation({"contact.stiffness", "contact.exponent", "contact.damping"}, known_.sources);
  forget_law(given_);
  is_law_of_presses_ = has_presses && !is_preliminary;
  has_changed_ = true;
}

}  // namespace pcavr
