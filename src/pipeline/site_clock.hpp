// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>

namespace pcavr {

/// [s] of a POSIX clock.
[[nodiscard]] inline double read_clock(clockid_t id) {
  timespec now{};
  ::clock_gettime(id, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Seconds since this object was made, by CLOCK_MONOTONIC, which no time server steps.
class SiteClock {
 public:
  [[nodiscard]] double now() const { return read_clock(CLOCK_MONOTONIC) - start_; }
  /// CLOCK_MONOTONIC [s] at `t` of this clock.
  [[nodiscard]] double monotonic(double t) const { return start_ + t; }

 private:
  double start_ = read_clock(CLOCK_MONOTONIC);
};

/// [s] of computing time of the calling thread.
[[nodiscard]] inline double thread_cpu() { return read_clock(CLOCK_THREAD_CPUTIME_ID); }

}  // namespace pcavr
