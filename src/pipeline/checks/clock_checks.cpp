// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "clock_checks.hpp"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/recordings/recording/stamp_units.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

namespace pcavr {
namespace {

constexpr char kImages[] = "depth.txt";
/// [s] Contacts last for a second or a few: a tool or a force that is sampled so slowly shows none.
constexpr double kMaxInterval = 1.0;

void warn_of(const ClockConflict& conflict, const Observer& observer) {
  observer.on_warning(conflict.message + "; put both on one clock");
}

/// Warns where the unit of tracked poses' stamps does not fit the recording's streams; those have
/// been compared with each other.
void warn_of_tracked_unit(const Recording& recording, const std::string& name,
                          const Trajectory& tracked, const Observer& observer) {
  std::vector<StreamPace> paces = paces_of(recording);
  if (!doubtful_stamp_units(paces).empty()) return;
  paces.push_back(pace_of(name, StreamPace::Kind::tracking, tracked));
  for (const std::string& warning : doubtful_stamp_units(paces)) observer.on_warning(warning);
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

std::optional<Error> check_rates(const Recording& recording) {
  using Kind = StreamPace::Kind;
  for (const StreamPace& pace : paces_of(recording)) {
    const bool is_used = pace.kind == Kind::tool || pace.kind == Kind::force;
    if (!is_used || pace.interval <= kMaxInterval) continue;
    const std::optional<std::string> unit = unit_of_interval(pace.interval);
    return Error{
        .message = fmt::format("one row in {:.3g} s: too few to show a contact", pace.interval),
        .file = (recording.folder / pace.name).string(),
        .hint = unit ? "write the stamps in seconds: they may be in " + *unit
                     : "record the stream at 10 rows a second or more"};
  }
  return std::nullopt;
}

void warn_of_clocks(const Recording& recording, const Observer& observer) {
  for (const ClockConflict& conflict : find_clock_conflicts(recording)) warn_of(conflict, observer);
}

void warn_of_tracked_clock(const Recording& recording, const std::string& object,
                           std::span<const TrackedPose> tracked, Stamp zero,
                           const Observer& observer) {
  if (tracked.empty() || recording.tool.empty()) return;
  const std::vector<TimedPose>& tool = recording.tool.poses();
  const std::string name = "tracking of " + object;
  std::vector<TimedPose> poses;
  poses.reserve(tracked.size());
  for (const TrackedPose& pose : tracked) {
    poses.push_back({zero + (Stamp::from_seconds(pose.t) - Stamp{}), pose.T_base_object});
  }
  const auto conflict = compare_clocks({name, poses.front().stamp, poses.back().stamp},
                                       {"tool.csv", tool.front().stamp, tool.back().stamp});
  if (conflict) warn_of(*conflict, observer);
  warn_of_tracked_unit(recording, name, Trajectory(std::move(poses)), observer);
}

}  // namespace pcavr
