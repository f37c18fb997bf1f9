// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace pcavr {

/// Schedule of the commands of the operator's motion. Times [s] are those of the scene.
class CommandSchedule {
 public:
  /// `step` [s]: between two commands.
  explicit CommandSchedule(double step) : step_(step) {}

  [[nodiscard]] bool has_begun() const { return zero_.has_value(); }
  /// The first command of a session is executed after `now`. `start` [s] of the motion at its cycle
  /// 0, `lead` [s] from sending a command to its execution.
  void begin(double now, double start, double lead) {
    start_ = start;
    lead_ = lead;
    const double passed = (now - *zero_ - start_) / step_;
    next_ = static_cast<std::size_t>(std::max(0.0, std::ceil(passed))) + 1;
  }
  /// The motion's own time 0.
  void set_zero(double zero) { zero_ = zero; }

  [[nodiscard]] std::size_t next() const { return next_; }
  void advance() { ++next_; }
  [[nodiscard]] double time_of(std::size_t cycle) const {
    return *zero_ + start_ + step_ * static_cast<double>(cycle);
  }
  [[nodiscard]] double lead() const { return lead_; }

 private:
  double step_;
  std::optional<double> zero_;
  double start_ = 0.0;
  double lead_ = 0.0;
  std::size_t next_ = 1;  ///< cycle
};

}  // namespace pcavr
