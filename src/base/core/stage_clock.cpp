// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/stage_clock.hpp"

#include <algorithm>

namespace pcavr {

void StageClock::begin(const std::string& stage) {
  end();
  const auto found = std::find_if(times_.begin(), times_.end(),
                                  [&](const StageTime& time) { return time.stage == stage; });
  current_ = static_cast<int>(found - times_.begin());
  if (found == times_.end()) times_.push_back({.stage = stage});
  wall_start_ = std::chrono::steady_clock::now();
  cpu_start_ = std::clock();
}

void StageClock::end() {
  if (current_ < 0) return;
  StageTime& time = times_[static_cast<std::size_t>(current_)];
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - wall_start_;
  time.wall_seconds += wall.count();
  time.cpu_seconds += static_cast<double>(std::clock() - cpu_start_) / CLOCKS_PER_SEC;
  current_ = -1;
}

}  // namespace pcavr
