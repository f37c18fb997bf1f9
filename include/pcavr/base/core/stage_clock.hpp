// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <ctime>
#include <string>
#include <vector>

namespace pcavr {

/// Wall and CPU time of one named stage of a run.
struct StageTime {
  std::string stage;
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;  ///< of the whole process, all threads
};

/// Profiler: accumulates time by stage, in the order in which stages first began. Not thread-safe.
class StageClock {
 public:
  /// Ends the current stage, if any, and begins (or resumes) `stage`.
  void begin(const std::string& stage);
  void end();
  [[nodiscard]] const std::vector<StageTime>& times() const { return times_; }

 private:
  std::vector<StageTime> times_;
  int current_ = -1;
  std::chrono::steady_clock::time_point wall_start_;
  std::clock_t cpu_start_ = 0;
};

}  // namespace pcavr
