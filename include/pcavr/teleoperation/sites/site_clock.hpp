// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>
#include <functional>
#include <utility>

namespace pcavr {

/// [s] of a POSIX clock.
[[nodiscard]] inline double read_clock(clockid_t id) {
  timespec now{};
  ::clock_gettime(id, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Seconds since this object was made, by CLOCK_BOOTTIME: no time server steps it, and it counts
/// while the machine sleeps, so that what waited meanwhile is seen to be old. In virtual time by
/// `source` [s] in its place.
class SiteClock {
 public:
  explicit SiteClock(std::function<double()> source = {})
      : source_(source ? std::move(source) : [] { return read_clock(CLOCK_BOOTTIME); }),
        start_(source_()) {}

  [[nodiscard]] double now() const { return source_() - start_; }
  /// CLOCK_MONOTONIC [s] at `t` of this clock.
  [[nodiscard]] double monotonic(double t) const { return start_monotonic_ + t; }

 private:
  std::function<double()> source_;
  double start_;
  double start_monotonic_ = read_clock(CLOCK_MONOTONIC);  ///< [s]; equal until the machine sleeps
};

/// [s] of computing time of the calling thread.
[[nodiscard]] inline double thread_cpu() { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

}  // namespace pcavr
