// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "phase_timeline.hpp"

namespace pcavr {

/// One of paper C's key times: contact, critical, sliding, stop and leave of one push. Pushes are
/// counted by the time of their contact, over all objects: the first has t1 to t5, the second t6 to
/// t10. A push without one of the five (it never slides) skips its number.
struct TimeNode {
  int number = 0;  ///< 1 for t1
  std::string object;
  TimedEvent event;
};

/// The contact, the first critical, the first sliding, the last stop, and the leave of each push.
[[nodiscard]] std::vector<TimeNode> time_nodes(
    const std::map<std::string, PhaseTimeline>& timelines);

}  // namespace pcavr
