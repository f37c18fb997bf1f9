// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/object_knowledge.hpp"

#include <algorithm>
#include <utility>

#include "pcavr/base/core/caught.hpp"

namespace pcavr {
namespace {

// Ratio of a contact's ages at two successive identifications, while its first law is looked for.
constexpr double kFirstLawGrowth = 1.25;
// Contacts of an object that are identified again when the clock's offset is found.
constexpr std::size_t kMaxUsed = 20;

}  // namespace

void ObjectKnowledge::forget() {
  identification_.reset();
  // Its thread takes longer than a cycle may wait.
  if (search_) search_->is_obsolete = true;
  current_ = given_;
  used_.clear();
}

void ObjectKnowledge::plan(bool begins_slide, bool ends_slide, bool ends_contact, double t) {
  if (begins_slide) planned_ = t + options_.delay_after_onset;
  if (ends_slide || ends_contact) planned_ = t + options_.delay_after_stop;
}

void ObjectKnowledge::plan_no_later_than(double t) {
  if (!planned_ || t < *planned_) planned_ = t;
}

bool ObjectKnowledge::is_due(double t) const {
  return !identification_ && planned_ && *planned_ <= t;
}

void ObjectKnowledge::begin_planned(double t, bool is_sliding) {
  planned_.reset();
  if (is_sliding) planned_ = t + options_.sliding_interval;
  last_planned_ = t;
}

bool ObjectKnowledge::was_planned_within(double t, double duration) const {
  return last_planned_ && t - *last_planned_ <= duration;
}

bool ObjectKnowledge::take_first_law_due(double t, double begin) {
  if (identification_) return false;
  const double tried = std::max(first_law_tried_.value_or(begin), begin);
  const double age = std::max(options_.delay_after_touch, kFirstLawGrowth * (tried - begin));
  if (t < begin + age) return false;
  first_law_tried_ = t;
  return true;
}

void ObjectKnowledge::use(const UsedContact& contact) {
  if (used_.empty() || used_.back().begin != contact.begin) used_.push_back({});
  if (used_.size() > kMaxUsed) used_.pop_front();
  used_.back() = contact;
}

void ObjectKnowledge::identify(const Background& background, double t,
                               std::optional<double> ceiling,
                               std::vector<ContactSamples> contacts) {
  current_.set_force_ceiling(ceiling);
  identification_.emplace(background, t, current_, std::move(contacts));
}

void ObjectKnowledge::identify_again(const Background& background, double t,
                                     std::optional<double> ceiling,
                                     std::vector<ContactSamples> contacts,
                                     OnlineIdentification old) {
  current_ = given_;
  identify(background, t, ceiling, std::move(contacts));
  current_ = std::move(old);
}

Expected<double> ObjectKnowledge::apply_identification() {
  Expected<OnlineIdentification> found = identification_->take();
  const double begin = identification_->begin();
  identification_.reset();
  if (!found) return found.error();
  current_ = *std::move(found);
  return begin;
}

void ObjectKnowledge::begin_search(const Background& background, double t, double suspected_turn) {
  if (search_) return;
  // An identification that was applied meanwhile had the suspicion of its begin.
  current_.set_suspected_turn(suspected_turn);
  if (std::optional<ObjectIdentifier> search = current_.next_search()) {
    search_.emplace(Search{PendingSearch(background, t, std::move(*search))});
  }
}

Expected<bool> ObjectKnowledge::apply_search() {
  const Search search = *std::exchange(search_, std::nullopt);
  if (search.is_obsolete) return false;
  const auto& found = search.pending.get();
  if (!found) return found.error();
  OnlineIdentification next = current_;
  const auto accepted = caught([&] { return next.accept(**found); });
  if (!accepted) return accepted.error();
  current_ = std::move(next);
  return true;
}

bool ObjectKnowledge::would_wait(double t) const {
  return (identification_ && identification_->would_wait(t)) ||
         (search_ && search_->pending.would_wait(t));
}

void ObjectKnowledge::update_static_limit(double t, std::optional<double> friction) {
  if (!friction) return above_limit_since_.reset();
  if (!above_limit_since_) above_limit_since_ = t;
  if (t - *above_limit_since_ < options_.static_limit_time) return;
  if (identification_) return;  // it may say so, and is used first
  const auto& supposed = current_.conservative_estimate().limiting_static_friction;
  if (supposed && *friction <= supposed->value) return;
  current_.raise_static_limit(*friction);
}

std::optional<std::string> ObjectKnowledge::take_contradiction(double begin) {
  if (!current_.contradiction() || contradicted_contact_ == begin) return std::nullopt;
  contradicted_contact_ = begin;
  return current_.contradiction();
}

}  // namespace pcavr
