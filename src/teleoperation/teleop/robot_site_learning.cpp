// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The robot's site: when, and from which samples, the parameters are identified.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

#include "teleoperation/teleop/robot_site.hpp"

namespace pcavr {
namespace {

// Time without contact before a contact that is recorded with it [s].
constexpr double kBefore = 0.3;
// A contact is processed once more after it has ended [s].
constexpr double kOldContact = 1.0;
// Ratio of a contact's ages at two successive identifications, while its first law is looked for:
// longer contacts take longer, so that all together cost a few times the last.
constexpr double kFirstLawGrowth = 1.25;
// Contacts of an object that are identified again when the clock's offset is found.
constexpr std::size_t kMaxLearned = 20;

}  // namespace

double RobotSite::stored_time() const {
  return options_.learning.max_contact_time + kBefore + kOldContact;
}

void RobotSite::check_static_limit(RobotObject& object, const TouchSample& sample) {
  if (!options_.identifies || object.is_shared) return;
  const bool rests =
      object.monitor.is_touched() && !object.monitor.is_press() && !slides(object.monitor.phase());
  const auto& known = object.acknowledged.limiting_static_friction;
  const double limit = std::max(options_.learning.static_limit_ratio * known->value,
                                known->value + 3.0 * known->std.value_or(0.0));
  // A tip that presses down, as in an oblique hole, adds to the support's normal force.
  const double weight = object.acknowledged.mass->value * options_.gravity();
  const double load_share = 1.0 + std::max(0.0, -sample.force_base.z()) / weight;
  const double friction = sample.force_base.head<2>().norm() / load_share;
  const bool is_beyond = rests && friction > limit + sensors_.enter_force;
  if (!is_beyond) {
    object.above_limit_since.reset();
    return;
  }
  if (!object.above_limit_since) object.above_limit_since = sample.t;
  if (sample.t - *object.above_limit_since < options_.learning.static_limit_time) return;
  if (object.identification) return;  // it may say so, and is used first
  const auto& supposed = object.knowledge.conservative_estimate().limiting_static_friction;
  if (supposed && friction <= supposed->value) return;
  object.knowledge.raise_static_limit(friction);
}

void RobotSite::plan_learning(RobotObject& object, MotionPhase before, bool was_touched, double t) {
  const MotionPhase now = object.monitor.phase();
  if (!was_touched && object.monitor.is_touched()) object.is_shared = false;
  if (!slides(before) && slides(now)) object.learn_at = t + options_.learning.delay_after_onset;
  if (slides(before) && !slides(now)) object.learn_at = t + options_.learning.delay_after_stop;
  if (was_touched && !object.monitor.is_touched())
    object.learn_at = t + options_.learning.delay_after_stop;
  if (!slides(now) || !object.monitor.is_touched()) return;
  for (const RobotObject& other : objects_) {
    if (&other == &object || !other.is_seen_moving()) continue;
    object.is_shared = true;
    note_once(object.source().name + " and " + other.source().name +
              " moved together: their shared force is not used to identify");
  }
}

/// The operator feels a multiple of the real force, or a fraction of it, with an assumed law: the
/// first law is identified from the beginning of a press, not once that is over. A push breaks
/// loose before long, and is identified then.
void RobotSite::update_first_law(RobotObject& object, double t) {
  const bool is_pressed = object.monitor.is_touched() && object.monitor.is_press();
  if (!is_pressed || object.identification || contact_law_of(object.knowledge.known())) return;
  const double begin = object.monitor.contact_begin();
  const double tried = std::max(object.first_law_tried.value_or(begin), begin);
  const double age =
      std::max(options_.learning.delay_after_touch, kFirstLawGrowth * (tried - begin));
  if (t < begin + age) return;
  object.first_law_tried = t;
  identify(object, t);
}

void RobotSite::apply_identification(RobotObject& object) {
  if (!object.identification) return;
  const bool had_law = contact_law_of(object.knowledge.known()).has_value();
  Expected<OnlineIdentification> knowledge = object.identification->take();
  const double begin = object.identification->begin();
  object.identification.reset();
  if (!knowledge) return note_failure(PendingIdentification::kTask, knowledge.error());
  object.knowledge = *std::move(knowledge);
  const bool is_first_law = !had_law && contact_law_of(object.knowledge.known());
  if (is_first_law && object.monitor.is_press()) object.correction_switch.send_again();
  note_contradiction(object, begin);
}

void RobotSite::apply_search(RobotObject& object) {
  if (!object.search) return;
  if (!object.search->is_obsolete) {
    accept(object, object.search->pending.get());
  }
  object.search.reset();
}

void RobotSite::accept(RobotObject& object,
                       const Expected<std::shared_ptr<const ObjectIdentifier::Result>>& findings) {
  if (!findings) return note_failure(PendingSearch::kTask, findings.error());
  OnlineIdentification next = object.knowledge;
  const auto accepted = caught([&] { return next.accept(**findings); });
  if (!accepted) return note_failure(PendingSearch::kTask, accepted.error());
  object.knowledge = std::move(next);
  note_contradiction(object, object.monitor.contact_begin());
}

void RobotSite::search_friction(RobotObject& object, double t) {
  if (object.search && object.search->pending.is_due(t)) apply_search(object);
  if (object.search) return;
  // An identification that was applied meanwhile had the suspicion of its begin.
  object.knowledge.set_suspected_turn(watch_.suspected_turn());
  if (std::optional<ObjectIdentifier> search = object.knowledge.next_search())
    object.search.emplace(RobotObject::Search{PendingSearch(background_, t, std::move(*search))});
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
  const bool is_sliding = object.monitor.is_touched() && slides(object.monitor.phase());
  object.learn_at.reset();
  if (is_sliding) object.learn_at = t + options_.learning.sliding_interval;
  object.last_learned = t;
  identify(object, t);
}

void RobotSite::identify(RobotObject& object, double t) {
  if (!options_.identifies || object.is_shared || !has_force(now_)) return;
  const double begin = object.monitor.contact_begin();
  if (t - begin > options_.learning.max_contact_time) return;
  if (const UnusableInterval* bad = unusable_in(begin, t)) {
    note_once("the contact at " + at_time(begin) + " is not used to identify: " + bad->reason);
    return;
  }
  if (object.learned.empty() || object.learned.back().begin != begin) object.learned.push_back({});
  if (object.learned.size() > kMaxLearned) object.learned.pop_front();
  object.learned.back() = {begin, t, {object.monitor.has_slid(), object.has_moved_in_contact()}};
  const RobotObject::IdentifiedOnline& contact = object.learned.back();
  std::vector<PendingIdentification::Contact> contacts;
  contacts.push_back(copy_of(object, contact));
  object.identification.emplace(background_, t, object.knowledge, std::move(contacts));
}

const UnusableInterval* RobotSite::unusable_in(double begin, double end) const {
  for (const UnusableInterval& bad : tip_.bad()) {
    if (bad.begin <= end && bad.end >= begin) return &bad;
  }
  return nullptr;
}

ContactRecord RobotSite::record_of(RobotObject& object,
                                   const RobotObject::IdentifiedOnline& contact) {
  object.knowledge.set_force_ceiling(force_.ceiling());
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
          object.tracked_between(contact.begin - kBefore, contact.until)};
}

void RobotSite::note_contradiction(RobotObject& object, double begin) {
  if (!object.knowledge.contradiction() || object.contradicted_contact == begin) return;
  object.contradicted_contact = begin;
  note_once(fmt::format("{}, contact at {}: {}", object.source().name, at_time(begin),
                        *object.knowledge.contradiction()));
}

PendingIdentification::Contact RobotSite::copy_of(RobotObject& object,
                                                  const RobotObject::IdentifiedOnline& contact) {
  return {record_of(object, contact), contact.begin, contact.facts};
}

void RobotSite::learn_again(double offset_change) {
  for (RobotObject& object : objects_) {
    const std::deque<RobotObject::IdentifiedOnline> contacts = std::exchange(object.learned, {});
    // Knowledge by the old clock is better than nothing until the contacts are learnt again.
    const OnlineIdentification known = object.knowledge;
    object.forget_learned();
    std::vector<PendingIdentification::Contact> again;
    for (RobotObject::IdentifiedOnline contact : contacts) {
      contact.begin -= offset_change;
      contact.until -= offset_change;
      if (contact.begin - kBefore < tip_.t().front()) continue;
      object.learned.push_back(contact);
      again.push_back(copy_of(object, contact));
    }
    if (again.empty()) continue;
    object.identification.emplace(background_, now_, object.knowledge, std::move(again));
    object.knowledge = known;
  }
}

}  // namespace pcavr
