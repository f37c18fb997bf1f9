// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace pcavr::detail {

/// Acceleration of a device's tip at its newest sample, by a cubic fitted to the latest positions:
/// unlike a parabola's, its second derivative does not lag (at 10 Hz and 10 samples 3 % of the
/// acceleration are lost; a parabola's error is 28 %). A micrometre of noise (std) gives 0.5 m/s^2.
/// Not thread-safe; neither allocates nor throws.
class TipAcceleration {
 public:
  /// `time` [s]: of the positions that are fitted; `limit` [m/s^2] of the result's norm.
  TipAcceleration(double time, double limit) noexcept : time_(time), limit_(limit) {}

  void reset() noexcept { count_ = 0; }
  /// A position `dt` [s] after the last one. Another `dt` than the last one's starts anew.
  void add(const Eigen::Vector3d& p, double dt) noexcept;
  /// [m/s^2]; zero until enough positions are known.
  [[nodiscard]] Eigen::Vector3d value() const noexcept;

 private:
  static constexpr int kMinSamples = 6;
  static constexpr int kMaxSamples = 64;
  void set_interval(double dt) noexcept;

  double time_;
  double limit_;
  double dt_ = 0.0;
  int size_ = 0;   ///< samples in the window
  int count_ = 0;  ///< samples known, at most size_
  int next_ = 0;   ///< where the next one goes
  std::array<Eigen::Vector3d, kMaxSamples> positions_;
  std::array<double, kMaxSamples> weights_{};  ///< [1/s^2], oldest first
};

}  // namespace pcavr::detail
