// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

std::vector<StreamSpan> spans_of(const Recording& recording) {
  std::vector<StreamSpan> spans;
  if (!recording.wrench.empty()) {
    spans.push_back({"wrench.csv", recording.wrench.front().stamp, recording.wrench.back().stamp});
  }
  if (!recording.tool.empty()) {
    const std::vector<TimedPose>& poses = recording.tool.poses();
    spans.push_back({"tool.csv", poses.front().stamp, poses.back().stamp});
  }
  if (!recording.frames.empty()) {
    spans.push_back(
        {"depth.txt", recording.frames.front().depth_stamp, recording.frames.back().depth_stamp});
  }
  return spans;
}

std::string range_of(const StreamSpan& span) {
  return format_stamp(span.first, 1) + " to " + format_stamp(span.last, 1) + " s";
}

}  // namespace

std::optional<ClockConflict> compare_clocks(const StreamSpan& a, const StreamSpan& b) {
  const double shared = to_seconds(std::min(a.last, b.last) - std::max(a.first, b.first));
  const double shorter = std::min(to_seconds(a.last - a.first), to_seconds(b.last - b.first));
  if (shared >= 0.0 && shared >= kMinClockOverlap * shorter) return std::nullopt;
  ClockConflict conflict{a.name, b.name, {}, shared < 0.0};
  conflict.message =
      a.name + " covers " + range_of(a) + ", " + b.name + " " + range_of(b) + ": they ";
  if (conflict.is_disjoint) {
    conflict.message += "do not overlap";
  } else {
    const auto milliseconds = static_cast<long long>(std::llround(1e3 * shared));
    const auto percent = static_cast<long long>(std::floor(1e2 * shared / shorter));
    conflict.message += "overlap for " + std::to_string(milliseconds) + " ms, " +
                        std::to_string(percent) + " % of the shorter";
  }
  return conflict;
}

std::vector<ClockConflict> find_clock_conflicts(const Recording& recording) {
  std::vector<ClockConflict> conflicts;
  const std::vector<StreamSpan> spans = spans_of(recording);
  for (std::size_t i = 0; i < spans.size(); ++i) {
    for (std::size_t k = i + 1; k < spans.size(); ++k) {
      if (auto conflict = compare_clocks(spans[i], spans[k])) {
        conflicts.push_back(std::move(*conflict));
      }
    }
  }
  return conflicts;
}

Error clock_error(const ClockConflict& conflict, const std::filesystem::path& folder) {
  return {.message = conflict.message, .file = folder.string(), .hint = "put both on one clock"};
}

Stamp start_of(const Recording& recording) {
  const std::vector<StreamSpan> spans = spans_of(recording);
  if (spans.empty()) return {};
  return std::min_element(spans.begin(), spans.end(),
                          [](const auto& a, const auto& b) { return a.first < b.first; })
      ->first;
}

}  // namespace pcavr
