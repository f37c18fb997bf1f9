// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The robot's site: when, and from which samples, the parameters are identified.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "teleoperation/teleop/robot_site.hpp"

namespace pcavr {
namespace {

// Time without contact before a contact that is recorded with it [s].
constexpr double kBefore = 0.3;
// A contact is processed once more after it has ended [s].
constexpr double kOldContact = 1.0;

}  // namespace

double RobotSite::stored_time() const {
  return options_.learning.max_contact_time + kBefore + kOldContact;
}

void RobotSite::check_static_limit(RobotObject& object, const TouchSample& sample) {
  if (!options_.identifies || object.is_shared()) return;
  const bool rests = object.monitor().is_touched() && !object.monitor().is_press() &&
                     !slides(object.monitor().phase());
  const auto& known = object.corrections().acknowledged().limiting_static_friction;
  const double limit = std::max(options_.learning.static_limit_ratio * known->value,
                                known->value + 3.0 * known->std.value_or(0.0));
  // A tip that presses down, as in an oblique hole, adds to the support's normal force.
  const double weight = object.corrections().acknowledged().mass->value * options_.gravity();
  const double load_share = 1.0 + std::max(0.0, -sample.force_base.z()) / weight;
  const double friction = sample.force_base.head<2>().norm() / load_share;
  const bool is_beyond = rests && friction > limit + sensors_.enter_force;
  object.knowledge().update_static_limit(
      sample.t, is_beyond ? std::optional<double>(friction) : std::nullopt);
}

void RobotSite::plan_learning(RobotObject& object, MotionPhase before, bool was_touched, double t) {
  const MotionPhase now = object.monitor().phase();
  if (!was_touched && object.monitor().is_touched()) object.set_shared(false);
  const bool ends_contact = was_touched && !object.monitor().is_touched();
  object.knowledge().plan(!slides(before) && slides(now), slides(before) && !slides(now),
                          ends_contact, t);
  if (!slides(now) || !object.monitor().is_touched()) return;
  for (const RobotObject& other : objects_) {
    if (&other == &object || !other.pose().is_seen_moving()) continue;
    object.set_shared(true);
    note_once(object.name() + " and " + other.name() +
              " moved together: their shared force is not used to identify");
  }
}

/// The operator feels a multiple of the real force, or a fraction of it, with an assumed law: the
/// first law is identified from the beginning of a press, not once that is over. A push breaks
/// loose before long, and is identified then.
void RobotSite::update_first_law(RobotObject& object, double t) {
  const bool is_pressed = object.monitor().is_touched() && object.monitor().is_press();
  if (!is_pressed || contact_law_of(object.knowledge().parameters())) return;
  if (object.knowledge().take_first_law_due(t, object.monitor().contact_begin())) {
    identify(object, t);
  }
}

void RobotSite::apply_identification(RobotObject& object) {
  ObjectKnowledge& knowledge = object.knowledge();
  if (!knowledge.has_identification()) return;
  const bool had_law = contact_law_of(knowledge.parameters()).has_value();
  const Expected<double> begin = knowledge.apply_identification();
  if (!begin) return note_failure(PendingIdentification::kTask, begin.error());
  const bool is_first_law = !had_law && contact_law_of(knowledge.parameters());
  if (is_first_law && object.monitor().is_press()) object.corrections().decision().send_again();
  note_contradiction(object, *begin);
}

void RobotSite::apply_search(RobotObject& object) {
  if (!object.knowledge().has_search()) return;
  const Expected<bool> applied = object.knowledge().apply_search();
  if (!applied) return note_failure(PendingSearch::kTask, applied.error());
  if (*applied) note_contradiction(object, object.monitor().contact_begin());
}

void RobotSite::search_friction(RobotObject& object, double t) {
  if (object.knowledge().is_search_due(t)) apply_search(object);
  object.knowledge().begin_search(background_, t, watch_.suspected_turn());
}

void RobotSite::apply_identifications() {
  for (RobotObject& object : objects_) {
    apply_identification(object);
    apply_search(object);
    search_friction(object, now_);
    apply_search(object);
  }
}

void RobotSite::learn(RobotObject& object, double t) {
  const bool is_sliding = object.monitor().is_touched() && slides(object.monitor().phase());
  object.knowledge().begin_planned(t, is_sliding);
  identify(object, t);
}

void RobotSite::identify(RobotObject& object, double t) {
  if (!options_.identifies || object.is_shared() || !has_force(now_)) return;
  const double begin = object.monitor().contact_begin();
  if (t - begin > options_.learning.max_contact_time) return;
  if (const UnusableInterval* bad = unusable_in(begin, t)) {
    note_once("the contact at " + at_time(begin) + " is not used to identify: " + bad->reason);
    return;
  }
  const ObjectKnowledge::UsedContact contact{
      begin, t, {object.monitor().has_slid(), object.pose().has_moved_in_contact()}};
  object.knowledge().use(contact);
  std::vector<ContactSamples> contacts;
  contacts.push_back(copy_of(object, contact));
  object.knowledge().identify(background_, t, force_.ceiling(), std::move(contacts));
}

const UnusableInterval* RobotSite::unusable_in(double begin, double end) const {
  for (const UnusableInterval& bad : tip_.bad()) {
    if (bad.begin <= end && bad.end >= begin) return &bad;
  }
  return nullptr;
}

ContactSamples RobotSite::copy_of(const RobotObject& object,
                                  const ObjectKnowledge::UsedContact& contact) const {
  const ForceStream::Record force = force_.between(contact.begin - kBefore, contact.until);
  const std::span<const double> t = tip_.t();
  const auto from = std::lower_bound(t.begin(), t.end(), contact.begin - kBefore);
  const auto to = std::upper_bound(from, t.end(), contact.until);
  const auto first = static_cast<std::size_t>(from - t.begin());
  const auto count = static_cast<std::size_t>(to - from);
  const std::span<const Eigen::Vector3d> p_base = tip_.p_base().subspan(first, count);
  return {{force.t.begin(), force.t.end()},
          {force.clean_base.begin(), force.clean_base.end()},
          {from, to},
          {p_base.begin(), p_base.end()},
          object.pose().tracked_between(contact.begin - kBefore, contact.until),
          contact.begin,
          contact.facts};
}

void RobotSite::note_contradiction(RobotObject& object, double begin) {
  if (const std::optional<std::string> text = object.knowledge().take_contradiction(begin)) {
    note_once(fmt::format("{}, contact at {}: {}", object.name(), at_time(begin), *text));
  }
}

void RobotSite::learn_again(double offset_change) {
  for (RobotObject& object : objects_) {
    ObjectKnowledge& knowledge = object.knowledge();
    const std::deque<ObjectKnowledge::UsedContact> contacts = knowledge.used();
    const OnlineIdentification old = knowledge.current();
    object.forget_learned();
    std::vector<ContactSamples> again;
    for (ObjectKnowledge::UsedContact contact : contacts) {
      contact.begin -= offset_change;
      contact.until -= offset_change;
      if (contact.begin - kBefore < tip_.t().front()) continue;
      knowledge.use(contact);
      again.push_back(copy_of(object, contact));
    }
    if (again.empty()) continue;
    knowledge.identify_again(background_, now_, force_.ceiling(), std::move(again), old);
  }
}

}  // namespace pcavr
