// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "time_nodes.hpp"

#include <algorithm>
#include <array>
#include <tuple>

namespace pcavr {
namespace {

constexpr std::size_t kNodesOfPush = 5;  // contact, critical, sliding, stop, leave

struct Push {
  std::string object;
  std::array<std::optional<Stamp>, kNodesOfPush> stamps{};  ///< by PhaseEvent
};

std::vector<Push> pushes_of(const std::string& object, const PhaseTimeline& timeline) {
  std::vector<Push> pushes;
  for (const TimedEvent& event : events_of(timeline)) {
    const auto kind = static_cast<std::size_t>(event.event);
    if (event.event == PhaseEvent::contact) pushes.push_back({.object = object});
    // Skips a push that began before the timeline.
    if (pushes.empty() || kind >= kNodesOfPush) continue;
    std::optional<Stamp>& stamp = pushes.back().stamps.at(kind);
    if (!stamp || event.event == PhaseEvent::stop) stamp = event.stamp;
  }
  return pushes;
}

}  // namespace

std::vector<TimeNode> time_nodes(const std::map<std::string, PhaseTimeline>& timelines) {
  std::vector<Push> pushes;
  for (const auto& [object, timeline] : timelines) {
    const std::vector<Push> more = pushes_of(object, timeline);
    pushes.insert(pushes.end(), more.begin(), more.end());
  }
  std::sort(pushes.begin(), pushes.end(), [](const Push& a, const Push& b) {
    return std::tie(*a.stamps[0], a.object) < std::tie(*b.stamps[0], b.object);
  });
  std::vector<TimeNode> nodes;
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    for (std::size_t kind = 0; kind < kNodesOfPush; ++kind) {
      const std::optional<Stamp>& stamp = pushes[i].stamps.at(kind);
      if (!stamp) continue;
      nodes.push_back({.number = static_cast<int>(kNodesOfPush * i + kind) + 1,
                       .object = pushes[i].object,
                       .event = {*stamp, kEvents.at(kind)}});
    }
  }
  return nodes;
}

}  // namespace pcavr
