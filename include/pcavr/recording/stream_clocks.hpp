// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/stamp.hpp"
#include "pcavr/recording/recording.hpp"

namespace pcavr {

/// From the first to the last stamp of one stream.
struct StreamSpan {
  std::string name;  ///< as messages name it, such as "wrench.csv"
  Stamp first;
  Stamp last;
};

/// Streams that share less than this of the shorter one are reported: the format has one clock for
/// all, and what is meant to be used together was recorded at the same time.
inline constexpr double kMinClockOverlap = 0.1;

/// Two streams whose stamps do not meet, or hardly.
struct ClockConflict {
  std::string first;         ///< name of the one stream
  std::string second;        ///< name of the other
  std::string message;       ///< both ranges, and what they share
  bool is_disjoint = false;  ///< they share nothing
};

/// Nothing where they share at least kMinClockOverlap of the shorter one.
[[nodiscard]] std::optional<ClockConflict> compare_clocks(const StreamSpan& a, const StreamSpan& b);

/// Each pair of tool.csv, wrench.csv and the images. Thread-safe.
[[nodiscard]] std::vector<ClockConflict> find_clock_conflicts(const Recording& recording);

/// The conflict as an Error; `folder` is the recording's.
[[nodiscard]] Error clock_error(const ClockConflict& conflict, const std::filesystem::path& folder);

/// The earliest stamp of tool.csv, wrench.csv and the images; 0 where all are absent. Seconds in
/// formulas, messages and plots count from here: a double holds seconds since 1970 to 0.2 us only.
[[nodiscard]] Stamp start_of(const Recording& recording);

}  // namespace pcavr
