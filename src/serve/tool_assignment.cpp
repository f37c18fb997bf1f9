// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tool_assignment.hpp"

#include <algorithm>
#include <utility>

namespace pcavr {

bool ToolAssignment::is_used_by_another(PageId page, double now) const {
  if (!holder_ || holder_ == page) return false;
  return is_engaged_ || now - last_engaged_ < idle_time_;
}

bool ToolAssignment::has_asked(PageId page) const {
  return std::find(requests_.begin(), requests_.end(), page) != requests_.end();
}

ToolAssignment::Answer ToolAssignment::request(PageId page, double now) {
  if (holder_ == page) return Answer::given;
  // Others that have asked before it come first, also for a free tool.
  const bool is_first = requests_.empty() || requests_.front() == page;
  if (is_first && !is_used_by_another(page, now)) {
    (void)give(page, Change::Reason::taken, now);
    return Answer::given;
  }
  if (has_asked(page)) return Answer::already_asked;
  const auto refused = refused_.find(page);
  if (refused != refused_.end() && now - refused->second < idle_time_) {
    return Answer::refused_before;
  }
  requests_.push_back(page);
  return Answer::asked;
}

bool ToolAssignment::release(PageId page) {
  std::erase(requests_, page);
  if (holder_ != page) return false;
  holder_.reset();
  return true;
}

bool ToolAssignment::leave(PageId page) {
  refused_.erase(page);
  return release(page);
}

std::optional<ToolAssignment::Change> ToolAssignment::hand_over(PageId holder, double now) {
  if (holder_ != holder || requests_.empty()) return std::nullopt;
  return give(requests_.front(), Change::Reason::handed_over, now);
}

std::deque<ToolAssignment::PageId> ToolAssignment::refuse(PageId holder, double now) {
  if (holder_ != holder) return {};
  for (const PageId page : requests_) refused_[page] = now;
  return std::exchange(requests_, {});
}

void ToolAssignment::use(bool is_engaged, double now) {
  last_use_ = now;
  if (is_engaged_ || is_engaged) last_engaged_ = now;
  is_engaged_ = is_engaged;
}

std::optional<ToolAssignment::Change> ToolAssignment::update(double now) {
  if (holder_ && is_engaged_ && now - last_use_ > timeout_) {
    return Change{Change::Reason::silent, std::exchange(holder_, std::nullopt), {}};
  }
  if (requests_.empty() || is_used_by_another(requests_.front(), now)) return std::nullopt;
  const auto reason = holder_ ? Change::Reason::idle : Change::Reason::taken;
  return give(requests_.front(), reason, now);
}

ToolAssignment::Change ToolAssignment::give(PageId page, Change::Reason reason, double now) {
  std::erase(requests_, page);
  refused_.erase(page);
  const Change change{reason, std::exchange(holder_, page), page};
  last_use_ = last_engaged_ = now;
  is_engaged_ = false;
  return change;
}

}  // namespace pcavr
