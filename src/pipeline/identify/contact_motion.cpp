// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "contact_motion.hpp"

#include <limits>
#include <span>

namespace pcavr {
namespace {

/// The part of a series that ends before `end`, from `from` on, which becomes its end.
template <typename T, typename Time>
std::vector<T> next_part(std::span<const T> series, double end, const Time& time_of,
                         std::size_t& from) {
  const std::size_t first = from;
  while (from < series.size() && time_of(from) < end) ++from;
  return {series.begin() + static_cast<std::ptrdiff_t>(first),
          series.begin() + static_cast<std::ptrdiff_t>(from)};
}

}  // namespace

std::vector<TrackedPose> on_clock(std::vector<TrackedPose> tracked, double offset) {
  for (TrackedPose& pose : tracked) pose.t -= offset;
  return tracked;
}

std::vector<std::shared_ptr<const Contact>> contacts_with_motion(
    const std::vector<Contact>& contacts, std::size_t object, const TipPath& tip,
    const std::vector<TrackedPose>& tracked) {
  std::vector<std::shared_ptr<const Contact>> result;
  std::vector<const Contact*> own;
  for (const Contact& contact : contacts) {
    if (contact.object == object) own.push_back(&contact);
  }
  std::size_t row = 0, points = 0, pose = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double end = i + 1 < own.size() ? 0.5 * (own[i]->end + own[i + 1]->begin)
                                          : std::numeric_limits<double>::infinity();
    const auto time_of_row = [&](std::size_t k) { return tip.t[k]; };
    auto contact = std::make_shared<Contact>(*own[i]);
    contact->t_tool = next_part(tip.t, end, time_of_row, row);
    contact->p_base_tip = next_part(tip.p_base, end, time_of_row, points);
    contact->tracked = next_part(
        std::span(tracked), end, [&](std::size_t k) { return tracked[k].t; }, pose);
    result.push_back(std::move(contact));
  }
  return result;
}

}  // namespace pcavr
