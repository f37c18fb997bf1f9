// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "pcavr/devices/remote_device.hpp"

namespace pcavr {

/// The motion between samples that come with jitter, run along by the sender's clock at a delay.
/// Positions in base. No allocation; one thread.
class TipPlayback {
 public:
  void clear() noexcept { *this = {}; }
  /// A sample that is newer than the last. One whose clock has nothing to do with the last one's
  /// starts the motion anew: true then.
  bool add(const RemoteSample& sample) noexcept;
  /// `dt` [s] >= 0 later, at `t` [s].
  void advance(double t, double dt) noexcept;

  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  [[nodiscard]] const RemoteSample& newest() const noexcept { return sample(count_ - 1); }
  /// [s] the moment that is shown, on the sender's clock.
  [[nodiscard]] double shown() const noexcept { return shown_; }
  /// [s] kept back, over the arrival that was fastest of late.
  [[nodiscard]] double delay() const noexcept { return kept_back_ - fastest_; }

  struct Place {
    Eigen::Vector3d p_base_tip;
    Eigen::Quaterniond q_base_tool;
  };
  /// Where it was at `clock` [s], the sender's; not empty. Held before the oldest kept and after
  /// the newest.
  [[nodiscard]] Place at(double clock) const noexcept;

 private:
  /// At 2 ms apart, the least, these cover the longest delay.
  static constexpr std::size_t kKept = 32;

  [[nodiscard]] const RemoteSample& sample(std::size_t i) const noexcept {
    return samples_[i % kKept];
  }
  [[nodiscard]] std::size_t oldest() const noexcept { return count_ > kKept ? count_ - kKept : 0; }
  void judge_arrivals() noexcept;

  std::array<RemoteSample, kKept> samples_{};  ///< number i is at i % kKept
  std::size_t count_ = 0;                      ///< so far
  double fastest_ = 0.0;  ///< [s] least of arrival - sender_clock: the clocks' offset, and the way
  double kept_back_ = 0.0;  ///< [s] t - shown that is aimed at; has the offset in it
  double shown_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace pcavr
