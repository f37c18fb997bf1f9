// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "pcavr/devices/device.hpp"

namespace pcavr {

/// Where a page's mouse, keyboard, controller or hand was.
struct RemoteSample {
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  bool is_engaged = false;    ///< the clutch is held
  double sender_clock = 0.0;  ///< [s] when it was so, on the sender's clock; ascends
  double arrival = 0.0;       ///< [s] when it came here, on the clock of exchange's `t`
  std::uint32_t sender = 0;   ///< who sent it: another sender is another hand, with another clock
};

struct RemoteDeviceOptions {
  std::string name = "remote";
  /// [m/s] > 0 of the tip. A hand that works on a table stays under 1 m/s and a reach under 2; a
  /// controller whose tracking slips goes at tens. At 2 m/s the tip moves 2 mm a cycle.
  double max_speed = 2.0;
  double max_silence = 0.5;  ///< [s] > 0 after which nobody is there, and the clutch is let go
};

/// What the newest exchange used.
struct RemoteUse {
  /// [s] of the newest sample; NaN before the first.
  double sender_clock = std::numeric_limits<double>::quiet_NaN();
  /// [s] of the moment that the tip shows now: it lies back by `delay`. NaN before the first.
  double shown_clock = std::numeric_limits<double>::quiet_NaN();
  double age = 0.0;    ///< [s] since the newest sample came here
  double delay = 0.0;  ///< [s] that the tip is kept back so that it can be drawn without a guess
  std::uint32_t sender = 0;
};

/// The device that a page is: samples come at 30 to 90 Hz with jitter, the tip goes at 1 kHz.
///
/// The tip runs along the straight lines between samples, by the sender's clock, kept back by the
/// least that lets a line be known before it is run along: an interval, and the jitter of the
/// arrivals, and a cycle. Just before a sample comes, the newest known is an interval old; less
/// delay would take a guess, and a tip that is guessed goes on into the wall when the hand has
/// stopped. So the tip is never where the hand was not, and never jumps: where a sample is late it
/// waits, then catches up smoothly.
///
/// A clutch that closes keeps the difference between tip and tool until it opens. It closes and
/// opens as soon as the sample is here; what was not yet run along when it opens is left out. After
/// a silence it has to open before it can close again.
///
/// `push` and `let_go` are for one thread at a time, `exchange` and `use` for one other; no call
/// waits, locks, allocates or throws.
class RemoteDevice final : public Device {
 public:
  /// Options finite and in range: PCAVR_REQUIRE.
  explicit RemoteDevice(RemoteDeviceOptions options = {});
  ~RemoteDevice() override;

  /// False, and counted as left out: not finite, farther than 100 m, not newer than what came
  /// before from this sender, less than 2 ms after it with the same clutch, or no room.
  bool push(const RemoteSample& sample) noexcept;
  /// The sender is gone: what it said is forgotten, and the tool let go.
  void let_go() noexcept;
  /// How many samples were left out so far. Any thread.
  [[nodiscard]] std::uint64_t left_out() const noexcept;

  [[nodiscard]] std::string_view name() const noexcept override;
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;
  [[nodiscard]] RemoteUse use() const noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
