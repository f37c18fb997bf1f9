// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "clock_checks.hpp"

#include "pcavr/recording/stream_clocks.hpp"

namespace pcavr {
namespace {

constexpr char kImages[] = "depth.txt";

void warn_of(const ClockConflict& conflict, const Observer& observer) {
  observer.on_warning(conflict.message + "; put both on one clock");
}

}  // namespace

std::optional<Error> check_clocks(const Recording& recording, ImageUse images,
                                  const Observer& observer) {
  for (const ClockConflict& conflict : find_clock_conflicts(recording)) {
    const bool has_images = conflict.first == kImages || conflict.second == kImages;
    const bool is_used = images == ImageUse::tracking || !has_images;
    if (conflict.is_disjoint && is_used) return clock_error(conflict, recording.folder);
    warn_of(conflict, observer);
  }
  return std::nullopt;
}

void warn_of_clocks(const Recording& recording, const Observer& observer) {
  for (const ClockConflict& conflict : find_clock_conflicts(recording)) warn_of(conflict, observer);
}

void warn_of_tracked_clock(const Recording& recording, const std::string& object,
                           std::span<const TrackedPose> tracked, const Observer& observer) {
  if (tracked.empty() || recording.tool.empty()) return;
  const std::vector<TimedPose>& tool = recording.tool.poses();
  const auto stamp = [start = start_of(recording)](double t) {
    return start + (Stamp::from_seconds(t) - Stamp{});
  };
  const auto conflict =
      compare_clocks({"tracking of " + object, stamp(tracked.front().t), stamp(tracked.back().t)},
                     {"tool.csv", tool.front().stamp, tool.back().stamp});
  if (conflict) warn_of(*conflict, observer);
}

}  // namespace pcavr
