// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// The time from the first to the last stamp of one stream.
struct StreamSpan {
  std::string name;  ///< as in messages, such as "wrench.csv"
  Stamp first;
  Stamp last;
};

/// Two streams whose overlap in time is less than this ratio of the shorter one are reported: the
/// format has one clock for all streams, and streams of one recording overlap.
inline constexpr double kMinClockOverlap = 0.1;

/// Two streams that do not overlap in time, or hardly: their clocks are probably not synchronised.
struct ClockConflict {
  std::string first;         ///< name of the first stream
  std::string second;        ///< name of the second
  std::string message;       ///< both time ranges, and their overlap
  bool is_disjoint = false;  ///< no overlap
};

/// nullopt where they overlap by at least kMinClockOverlap of the shorter one.
[[nodiscard]] std::optional<ClockConflict> compare_clocks(const StreamSpan& a, const StreamSpan& b);

/// Compares each pair of tool.csv, wrench.csv and the images. Thread-safe.
[[nodiscard]] std::vector<ClockConflict> find_clock_conflicts(const Recording& recording);

/// The conflict as an Error; `folder` is the recording's.
[[nodiscard]] Error clock_error(const ClockConflict& conflict, const std::filesystem::path& folder);

/// The earliest stamp of tool.csv, wrench.csv and the images; 0 where all are absent. Seconds in
/// formulas, messages and plots are relative to it: a double resolves seconds since 1970 to 0.2 us
/// only.
[[nodiscard]] Stamp start_of(const Recording& recording);

}  // namespace pcavr
