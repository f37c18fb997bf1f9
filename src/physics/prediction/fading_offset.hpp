// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::detail {

/// Offset of the displayed from the predicted state, six numbers, that fades to zero: a quintic in
/// time (blending polynomial) that begins with a value and a rate and ends with zero value, rate
/// and acceleration, so that neither position nor speed of the display jumps, however often it
/// restarts.
class FadingOffset {
 public:
  void begin(double t, double duration, const Vector6d& value, const Vector6d& rate) noexcept {
    t_ = t;
    duration_ = duration;
    value_ = value;
    rate_ = rate;
  }
  [[nodiscard]] Vector6d value_at(double t) const noexcept {
    if (!is_active_at(t)) return Vector6d::Zero();
    const double s = (t - t_) / duration_;
    const double cube = s * s * s;
    return (1.0 + cube * (-10.0 + s * (15.0 - 6.0 * s))) * value_ +
           duration_ * (s + cube * (-6.0 + s * (8.0 - 3.0 * s))) * rate_;
  }
  [[nodiscard]] Vector6d rate_at(double t) const noexcept {
    if (!is_active_at(t)) return Vector6d::Zero();
    const double s = (t - t_) / duration_;
    const double square = s * s;
    return square * (-30.0 + s * (60.0 - 30.0 * s)) / duration_ * value_ +
           (1.0 + square * (-18.0 + s * (32.0 - 15.0 * s))) * rate_;
  }

 private:
  /// False before the first begin(), also for negative times: no division by a zero duration.
  [[nodiscard]] bool is_active_at(double t) const noexcept {
    return duration_ > 0.0 && t - t_ < duration_;
  }

  double t_ = 0.0;         ///< [s]
  double duration_ = 0.0;  ///< [s]; 0: no offset
  Vector6d value_ = Vector6d::Zero();
  Vector6d rate_ = Vector6d::Zero();  ///< [1/s]
};

}  // namespace pcavr::detail
