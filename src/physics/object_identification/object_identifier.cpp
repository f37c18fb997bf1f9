// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object_identification/object_identifier.hpp"

#include <algorithm>
#include <utility>

#include "physics/object_identification/contact_fits.hpp"
#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

/// A press under which the object slides or turns, as in an oblique hole, shows no contact law: the
/// tip's path is not its penetration.
void leave_out_moved_presses(std::vector<Contact>& contacts,
                             const std::vector<TrackedPose>& tracked, const PathView& tip) {
  constexpr double kMaxMotion = 0.001;  // [m] where the tip is; tracking has some tenths of that
  if (tracked.empty()) return;
  for (Contact& contact : contacts) {
    const bool is_press = contact.kind == ContactKind::press && !contact.impact;
    if (!is_press || !contact.left_out.empty()) continue;
    const Pose T_base_before = pose_at(tracked, contact.begin);
    const Pose T_base_after = pose_at(tracked, contact.end);
    const Eigen::Vector3d p_base = tip.at(contact.begin);
    const Eigen::Vector3d p_base_after = T_base_after * (T_base_before.inverse() * p_base);
    if ((p_base_after - p_base).norm() > kMaxMotion) {
      contact.left_out = "the object moves under the press";
    }
  }
}

/// [s] In all slides of the pushes with an object.
double sliding_duration(std::vector<Contact>& contacts, std::size_t object) {
  double duration = 0.0;
  for (const Contact* push : contacts_of(contacts, object, false)) {
    for (const SlideInterval& slide : push->slides) duration += slide.end - slide.begin;
  }
  return duration;
}

/// The contacts one after the other, with one path and one track.
struct JoinedContacts {
  std::vector<Contact> contacts;
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<TrackedPose> tracked;

  void add(const Contact& one) {
    Contact& contact = contacts.emplace_back(one);
    move_to(t_tool, contact.t_tool);
    move_to(p_base_tip, contact.p_base_tip);
    move_to(tracked, contact.tracked);
  }

 private:
  template <typename T>
  static void move_to(std::vector<T>& all, std::vector<T>& part) {
    all.insert(all.end(), part.begin(), part.end());
    part = std::vector<T>();  // without its capacity
  }
};

ObjectParameters with_weighed_mass(ObjectParameters known, const IdentifiableObject& object) {
  if (!known.mass && object.mass) known.mass = ParameterValue{*object.mass, {}};
  return known;
}

}  // namespace

ObjectIdentifier::ObjectIdentifier(const IdentifiableObject& object, ObjectParameters known,
                                   double tool_radius, IdentificationGoal goal,
                                   const IdentificationOptions& options)
    : object_(&object),
      surface_(std::make_shared<const BodySurface>(object.model)),
      known_(with_weighed_mass(std::move(known), object)),
      tool_radius_(tool_radius),
      goal_(goal),
      options_(options),
      contact_fits_(std::make_shared<ContactFits>()) {}

ObjectIdentifier ObjectIdentifier::with(ObjectParameters known, IdentificationGoal goal) const {
  ObjectIdentifier other = *this;
  other.known_ = with_weighed_mass(std::move(known), *object_);
  other.goal_ = goal;
  return other;
}

void ObjectIdentifier::add(std::shared_ptr<const Contact> contact) {
  const auto after = std::upper_bound(
      contacts_.begin(), contacts_.end(), contact,
      [](const auto& one, const auto& other) { return one->begin < other->begin; });
  contacts_.insert(after, std::move(contact));
}

ObjectIdentifier::Result ObjectIdentifier::result() const {
  JoinedContacts joined;
  for (const auto& contact : contacts_) joined.add(*contact);
  std::vector<Contact>& contacts = joined.contacts;
  const std::size_t index = contacts.empty() ? 0 : contacts.front().object.value_or(0);
  const PathView tip(joined.t_tool, joined.p_base_tip);
  const BodyMotion motion{object_->model, joined.tracked};

  ObjectIdentification found{
      .name = object_->name, .is_movable = object_->is_movable, .parameters = known_};
  identify_tool_friction_of(contacts, index, motion, *surface_, tip, tool_radius_, found);
  if (object_->is_movable) leave_out_moved_presses(contacts, joined.tracked, tip);
  if (is_contact_assumed(found.parameters)) forget_contact(found.parameters);
  const bool has_contact_law = found.parameters.contact_stiffness.has_value();
  if (goal_ == IdentificationGoal::contact || !has_contact_law) {
    identify_contact_of(contacts, index, tip, options_, *contact_fits_, found);
    identify_surface_offset(contacts, index, *object_, *surface_, tool_radius_, tip, found);
  }
  if (goal_ == IdentificationGoal::friction && object_->is_movable) {
    identify_friction_of(contacts, index, object_->mass, motion, tip, tool_radius_, options_,
                         found);
    check_press_lines(contacts, index, options_.inputs.segmentation.breakaway, found);
  }
  doubt_force_direction(suspected_turn_, known_, found);
  doubt_force_scale(*object_, known_, found);
  withhold_contact_off_centre(found);
  if (object_->is_movable) assume_contact_by_loading(contacts, index, found);
  state_penetration(options_.contact_fit, found);
  state_findings(goal_, *object_, sliding_duration(contacts, index), found);
  return {std::move(found), std::move(contacts)};
}

}  // namespace pcavr
