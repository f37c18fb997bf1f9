// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>

#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// Stamps of CLOCK_REALTIME as it was at the start, carried on by CLOCK_MONOTONIC: a time server
/// that sets the clock does not tear the recording's times apart. Thread-safe.
class RecordClock {
 public:
  [[nodiscard]] Stamp now() const { return {offset_ + read(CLOCK_MONOTONIC)}; }
  /// The stamp of a time on CLOCK_MONOTONIC [s].
  [[nodiscard]] Stamp at(double monotonic) const {
    return {offset_ + Stamp::from_seconds(monotonic).nanoseconds};
  }

 private:
  static std::int64_t read(clockid_t id) {
    timespec time{};
    ::clock_gettime(id, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  }

  const std::int64_t offset_ = read(CLOCK_REALTIME) - read(CLOCK_MONOTONIC);  ///< [ns]
};

}  // namespace pcavr
