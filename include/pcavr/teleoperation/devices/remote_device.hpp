// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "pcavr/teleoperation/devices/device.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// A sample of a page's mouse, keyboard, controller or tracked hand.
struct RemoteSample {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  bool is_engaged = false;    ///< the clutch is closed
  double sender_clock = 0.0;  ///< [s] time of the sample, on the sender's clock; ascends
  double arrival = 0.0;       ///< [s] time of arrival, on the clock of exchange's `t`
  std::uint32_t sender = 0;   ///< another sender has another hand and clock
};

struct RemoteDeviceOptions {
  RemoteDeviceOptions();
  std::string name;     ///< "remote"
  double max_speed;     ///< [m/s] speed limit of the tip
  double timeout;       ///< [s] without a sample: the device is absent, the clutch opens (watchdog)
  double min_interval;  ///< [s] between two samples: rate limit
  double max_delay;     ///< [s] of the playout; at most 31 intervals
  double catch_up_time;  ///< [s] time constant with which a late tip catches up
};
[[nodiscard]] OptionSection section_of(RemoteDeviceOptions& options);

/// The samples and timing of the newest exchange.
struct RemoteStatus {
  /// [s] of the newest sample; NaN before the first.
  double sender_clock = std::numeric_limits<double>::quiet_NaN();
  /// [s] playout time of the tip on the sender's clock: behind by `delay`. NaN before the first.
  double shown_clock = std::numeric_limits<double>::quiet_NaN();
  double age = 0.0;    ///< [s] since the newest sample arrived
  double delay = 0.0;  ///< [s] playout delay, so that the tip is interpolated, not extrapolated
  std::uint32_t sender = 0;
};

/// A page as input device: samples arrive at 30 to 90 Hz with jitter, the tip is updated at 1 kHz
/// through a jitter buffer.
///
/// The tip is interpolated linearly between samples, by the sender's clock, with the smallest
/// playout delay at which the end of each segment has arrived: an interval, plus the jitter of the
/// arrivals, plus a cycle. A smaller delay would need extrapolation, and an extrapolated tip
/// overshoots into walls when the hand stops. So the tip is always on the hand's path, and never
/// jumps: if a sample is late the tip stops, then catches up smoothly.
///
/// A clutch that closes keeps the offset between tip and tool until it opens. It closes and opens
/// on arrival of the sample; motion that was not played out before opening is discarded. After a
/// timeout it must open before it can close again.
///
/// `push` and `release` are for one thread at a time, `exchange` and `status` for one other; no
/// call waits, locks, allocates or throws.
class RemoteDevice final : public Device {
 public:
  /// Options finite and in range: PCAVR_REQUIRE.
  explicit RemoteDevice(RemoteDeviceOptions options = {});
  ~RemoteDevice() override;

  /// False, and counted as rejected: not finite, farther than 100 m, not newer than the last one of
  /// this sender, less than `min_interval` after it with the same clutch (rate limit), or the queue
  /// is full.
  bool push(const RemoteSample& sample) noexcept;
  /// The sender has disconnected: discards its samples and opens the clutch.
  void release() noexcept;
  /// Number of samples rejected so far. Any thread.
  [[nodiscard]] std::uint64_t rejected() const noexcept;

  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;
  [[nodiscard]] RemoteStatus status() const noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
