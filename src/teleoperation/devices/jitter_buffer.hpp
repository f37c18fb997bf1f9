// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "pcavr/teleoperation/devices/remote_device.hpp"

namespace pcavr {

/// A jitter buffer: plays out samples that arrive with jitter by the sender's clock, interpolated,
/// at an adaptive playout delay. Positions in base. No allocation; one thread.
class JitterBuffer {
 public:
  /// `max_delay` [s] of the playout, `catch_up_time` [s] > 0 the time constant for catching up.
  JitterBuffer(double max_delay, double catch_up_time) noexcept
      : max_delay_(max_delay), catch_up_time_(catch_up_time) {}
  /// Whether it holds the samples of the maximum delay at that minimum interval [s].
  [[nodiscard]] static bool covers(double max_delay, double min_interval) noexcept {
    return max_delay <= (kSize - 1) * min_interval;
  }

  void clear() noexcept { *this = JitterBuffer(max_delay_, catch_up_time_); }
  /// Adds a sample newer than the last. A jump of the sender's clock restarts the motion: returns
  /// true.
  bool add(const RemoteSample& sample) noexcept;
  /// Advances the playout time by a cycle of `dt` [s] >= 0, to `t` [s].
  void advance(double t, double dt) noexcept;

  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  [[nodiscard]] const RemoteSample& newest() const noexcept { return sample(count_ - 1); }
  /// [s] playout time, on the sender's clock.
  [[nodiscard]] double shown() const noexcept { return shown_; }
  /// [s] playout delay relative to the fastest recent arrival.
  [[nodiscard]] double delay() const noexcept { return target_lag_ - fastest_; }

  struct Tip {
    Eigen::Vector3d p_base_tip;
    Eigen::Quaterniond q_base_tool;
  };
  /// The tip at `clock` [s] of the sender; not empty. Constant before the oldest and after the
  /// newest stored sample.
  [[nodiscard]] Tip at(double clock) const noexcept;

 private:
  /// The samples cover 62 ms at an interval of 2 ms, half a second at a page's 60 Hz.
  static constexpr std::size_t kSize = 32;

  [[nodiscard]] const RemoteSample& sample(std::size_t i) const noexcept {
    return samples_[i % kSize];
  }
  [[nodiscard]] std::size_t oldest() const noexcept { return count_ > kSize ? count_ - kSize : 0; }
  void update_delay() noexcept;

  double max_delay_;
  double catch_up_time_;
  std::array<RemoteSample, kSize> samples_{};  ///< number i is at i % kSize
  std::size_t count_ = 0;                      ///< so far
  double fastest_ =
      0.0;  ///< [s] minimum of arrival - sender_clock: clock offset plus minimum latency
  double target_lag_ = 0.0;  ///< [s] target of t - shown; includes the clock offset
  double shown_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace pcavr
