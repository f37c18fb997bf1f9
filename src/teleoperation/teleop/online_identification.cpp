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
  if (nearest == found.contacts.end() || !is_usable(*nearest, record, facts)) return false;
  ContactEpisode episode = *nearest;
  if (facts.has_slid && !is_press(episode)) check_breakaway(episode);
  auto contact = observed(record, found, episode, facts);
  if (!contact->t_tool.empty()) store(std::move(contact), facts.has_slid);
  return has_changed_;
}

bool OnlineIdentification::add(std::shared_ptr<const ObservedContact> contact, bool has_slid) {
  has_changed_ = false;
  store(std::move(contact), has_slid);
  return has_changed_;
}

void OnlineIdentification::store(std::shared_ptr<const ObservedContact> contact, bool has_slid) {
  const ContactEpisode& episode = contact->contact.episode;
  if (!contacts_.empty() &&
      std::abs(contacts_.back()->contact.episode.begin - episode.begin) < kSameContact)
    contacts_.pop_back();
  contacts_.push_back(contact);
  forget_old_contacts();
  // A press that goes on as a push is no press any more.
  is_law_of_presses_ &= std::ranges::any_of(
      contacts_, [this](const auto& one) { return is_press(one->contact.episode); });
  const bool shows_friction = has_slid && !is_press(episode);
  has_slid_ = has_slid_ || shows_friction;
  is_search_due_ = has_slid_;
  learn_contact();
  if (shows_friction) assume_friction(episode);
}

bool OnlineIdentification::is_usable(const ContactEpisode& contact, const ContactRecord& record,
                                     const ContactFacts& facts) const {
  // Empty: the tool was not recorded meanwhile.
  if (contact.t.empty() || contact.impact) return false;
  if (force_ceiling_ && contact.peak_force >= kSaturatedRatio * *force_ceiling_) return false;
  const bool shows_law =
      contact.peak_force >= options_.min_peak_force && contact.t.size() >= kMinContactSamples;
  if (!shows_law && (is_press(contact) || !facts.has_slid)) return false;
  if (facts.has_moved && !facts.has_slid && !is_press(contact)) return false;
  return !object_->is_movable || !is_oblique(record, contact, facts);
}

double OnlineIdentification::path_end_before(double begin) const {
  const auto before = std::find_if(contacts_.rbegin(), contacts_.rend(), [&](const auto& contact) {
    return std::abs(contact->contact.episode.begin - begin) >= kSameContact;
  });
  return before == contacts_.rend() ? -std::numeric_limits<double>::infinity()
                                    : (*before)->t_tool.back();
}

std::shared_ptr<const ObservedContact> OnlineIdentification::observed(
    const ContactRecord& record, const Segmentation& found, const ContactEpisode& episode,
    const ContactFacts& facts) const {
  auto observed = std::make_shared<ObservedContact>();
  const double from = path_end_before(episode.begin);
  const auto first = std::upper_bound(record.t_tool.begin(), record.t_tool.end(), from);
  observed->t_tool.assign(first, record.t_tool.end());
  observed->p_base_tip.assign(record.p_base_tip.begin() + (first - record.t_tool.begin()),
                              record.p_base_tip.end());
  std::copy_if(record.tracked.begin(), record.tracked.end(), std::back_inserter(observed->tracked),
               [from](const TrackedPose& pose) { return pose.t > from; });
  IdentifiedContact& contact = observed->contact;
  contact.episode = episode;
  contact.object = 0;
  if (!facts.has_slid) {
    contact.episode.breakaway.is_found = false;
    contact.episode.slides.clear();
    if (episode.kind == ContactKind::slide) contact.episode.kind = ContactKind::push;
  }
  const auto at = std::lower_bound(record.t_force.begin(), record.t_force.end(), episode.t.front());
  const auto force = found.force_base.begin() + (at - record.t_force.begin());
  contact.force_base.assign(force, force + std::ssize(episode.t));
  const PathView tip(record.t_tool, record.p_base_tip);
  const bool is_tracked = !record.tracked.empty();
  const Pose T_base_object =
      is_tracked ? pose_at(record.tracked, episode.begin) : object_->T_base_object;
  // Of an object that may be anywhere, the contacts along one direction are on one face.
  contact.normal_object =
      is_tracked ? identifier_.surface()
                       .touch(T_base_object, tip.at(episode.begin), tool_radius_)
                       .normal_object
                 : Eigen::Vector3d(T_base_object.rotation().inverse() * -episode.direction_base);
  std::vector<Eigen::Vector3d> directions_base;
  for (const auto& other : contacts_) {
    if (std::abs(other->contact.episode.begin - episode.begin) >= kSameContact)
      directions_base.push_back(other->contact.episode.direction_base);
  }
  align_with_face(T_base_object, object_->model.centre_of_mass_object, tip, directions_base,
                  contact);
  if (!is_tracked) contact.lever = 0.0;
  return observed;
}

void OnlineIdentification::forget_old_contacts() {
  const bool presses = is_press(contacts_.back()->contact.episode);
  const auto is_same_kind = [&](const auto& contact) {
    return is_press(contact->contact.episode) == presses;
  };
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

bool OnlineIdentification::is_press(const ContactEpisode& contact) const {
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
  const double force = contacts_.back()->contact.episode.peak_force;
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
    if (is_press(contact->contact.episode)) of_presses.add(contact);
  }
  if (of_presses.size() > 0) {
    ObjectIdentification found = of_presses.result().object;
    if (found.presses.best().is_valid || of_presses.size() == contacts_.size()) return found;
  }
  return identifier(without_law, IdentificationGoal::contact).result().object;
}

void OnlineIdentification::learn_contact() {
  const bool is_push = !is_press(contacts_.back()->contact.episode);
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
    fit = preliminary_law(found.presses, contacts_.back()->contact.episode.peak_force);
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
