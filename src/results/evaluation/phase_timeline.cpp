// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "phase_timeline.hpp"

#include <algorithm>

namespace pcavr {
namespace {

constexpr std::array<std::string_view, kPhaseCount> kPhaseNames = {"free", "static", "critical",
                                                                   "sliding"};
constexpr std::array<std::string_view, kEventCount> kEventNames = {"contact", "critical", "sliding",
                                                                   "stop",    "leave",    "eased"};

}  // namespace

std::string_view to_string(Phase phase) { return kPhaseNames.at(static_cast<std::size_t>(phase)); }

std::optional<Phase> phase_from_string(std::string_view name) {
  const auto found = std::find(kPhaseNames.begin(), kPhaseNames.end(), name);
  if (found == kPhaseNames.end()) return std::nullopt;
  return kPhases.at(static_cast<std::size_t>(found - kPhaseNames.begin()));
}

std::optional<Phase> phase_at(const PhaseTimeline& timeline, Stamp stamp) {
  const auto after =
      std::upper_bound(timeline.begin(), timeline.end(), stamp,
                       [](Stamp value, const PhaseChange& change) { return value < change.stamp; });
  if (after == timeline.begin()) return std::nullopt;
  return (after - 1)->phase;
}

std::string_view to_string(PhaseEvent event) {
  return kEventNames.at(static_cast<std::size_t>(event));
}

std::vector<TimedEvent> events_of(const PhaseTimeline& timeline) {
  std::vector<TimedEvent> events;
  for (std::size_t i = 1; i < timeline.size(); ++i) {
    const Phase from = timeline[i - 1].phase;
    const Phase to = timeline[i].phase;
    const auto add = [&](bool happens, PhaseEvent event) {
      if (happens) events.push_back({timeline[i].stamp, event});
    };
    add(from == Phase::free, PhaseEvent::contact);
    add(from == Phase::sliding, PhaseEvent::stop);
    add(from == Phase::critical && to == Phase::static_contact, PhaseEvent::eased);
    add(to == Phase::critical, PhaseEvent::critical);
    add(to == Phase::sliding, PhaseEvent::sliding);
    add(to == Phase::free, PhaseEvent::leave);
  }
  return events;
}

}  // namespace pcavr
