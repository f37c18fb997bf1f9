// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "teleoperation/teleop/operator_site.hpp"

namespace pcavr {

/// The operator site's recent predictions by time and object, as received with its commands.
class PredictionLog {
 public:
  PredictionLog(double start, double step, std::size_t objects)
      : start_(start), step_(step), objects_(objects) {}
  /// [s] When the first cycle began: the operator's site knows nothing of earlier times.
  [[nodiscard]] double start() const { return start_; }
  void append(const Prediction& prediction) { rows_.push_back(prediction); }
  /// Appends the predictions of the cycle that is `cycles` after the newest one, by object. The
  /// predictions of lost commands between both are interpolated.
  void append_after(std::size_t cycles, const std::vector<Prediction>& newest);
  /// The prediction of the cycle that ended nearest to `t`; the first or last one outside. Throws
  /// ContractError if it was discarded.
  [[nodiscard]] const Prediction& at(double t, std::size_t object) const;
  /// Predictions for times before `t` will not be requested again.
  void discard_before(double t);

 private:
  double start_;
  double step_;
  std::size_t objects_;
  std::size_t discarded_ = 0;     ///< cycles
  std::vector<Prediction> rows_;  ///< by cycle, then by object
  [[nodiscard]] std::size_t cycle_at(double t) const;
};

}  // namespace pcavr
