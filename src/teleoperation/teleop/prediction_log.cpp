// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/prediction_log.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {

namespace {

Prediction between(const Prediction& before, const Prediction& after, double share) {
  Prediction prediction = after;
  const double turn = std::remainder(after.pose.yaw - before.pose.yaw, 2.0 * M_PI);
  prediction.pose = {std::lerp(before.pose.x, after.pose.x, share),
                     std::lerp(before.pose.y, after.pose.y, share), before.pose.yaw + share * turn};
  prediction.force_base += (1.0 - share) * (before.force_base - after.force_base);
  prediction.rendered_force_base +=
      (1.0 - share) * (before.rendered_force_base - after.rendered_force_base);
  return prediction;
}

}  // namespace

void PredictionLog::append_after(std::size_t cycles, const std::vector<Prediction>& newest) {
  PCAVR_REQUIRE(newest.size() == objects_, newest.size(), objects_);
  std::vector<Prediction> before;
  if (cycles > 1 && !rows_.empty()) {
    before.assign(rows_.end() - static_cast<std::ptrdiff_t>(objects_), rows_.end());
  }
  for (std::size_t k = 1; k < cycles; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(cycles);
    for (std::size_t i = 0; i < objects_; ++i) {
      append(before.empty() ? newest[i] : between(before[i], newest[i], share));
    }
  }
  for (const Prediction& prediction : newest) append(prediction);
}

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
