// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/prediction_log.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"

namespace pcavr {

std::size_t PredictionLog::cycle_at(double t) const {
  const std::size_t cycles = discarded_ + rows_.size() / objects_;
  const double cycle =
      std::clamp(std::round((t - start_) / step_) - 1.0, 0.0, static_cast<double>(cycles - 1));
  return static_cast<std::size_t>(cycle);
}

const Prediction& PredictionLog::at(double t, std::size_t object) const {
  const std::size_t cycle = cycle_at(t);
  PCAVR_REQUIRE(cycle >= discarded_, t, cycle, discarded_);
  return rows_[(cycle - discarded_) * objects_ + object];
}

void PredictionLog::discard_before(double t) {
  // Rarely, in large blocks: the remaining rows must be moved.
  constexpr std::size_t kMinBlock = 4096;  // cycles: some seconds
  if (rows_.empty() || cycle_at(t) < discarded_ + kMinBlock) return;
  const std::size_t old = cycle_at(t) - discarded_;
  rows_.erase(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(old * objects_));
  discarded_ += old;
}

}  // namespace pcavr
