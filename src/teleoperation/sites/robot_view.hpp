// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "pcavr/teleoperation/link/delay_stages.hpp"
#include "pcavr/teleoperation/link/link_clock.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

namespace pcavr {

/// Knowledge of an operator's site about the robot in a session: its newest state, and how long the
/// newest command in it took by stage.
class RobotView {
 public:
  void begin() { *this = {}; }

  void add_command(double t, double sent, std::optional<double> device_clock) {
    sent_.add(t, sent, device_clock);
  }
  /// A state that has arrived `now`, unless a newer one has overtaken it. True if it names a
  /// command of this session: the delays are new.
  bool add_state(const LinkHeader& header, LinkState state, const LinkClock& shared_clock,
                 const SiteClock& clock, double now) {
    if (header.sequence <= sequence_) return false;
    sequence_ = header.sequence;
    state_ = std::move(state);
    if (!shared_clock.is_known()) return false;
    const std::optional<SentCommands::Sent> sent = sent_.find(state_->executed);
    if (!sent) return false;
    const auto local = [&](double shared) {
      return clock.monotonic(shared_clock.local_at(shared));
    };
    delays_ = DelayStamps{sent->device_clock,      clock.monotonic(sent->sent),
                          local(state_->received), local(state_->applied),
                          local(state_->t),        local(header.clock),
                          clock.monotonic(now)};
    return true;
  }

  [[nodiscard]] const LinkState* state() const { return state_ ? &*state_ : nullptr; }
  /// Stamps of the newest command whose effect has come back [s, CLOCK_MONOTONIC].
  [[nodiscard]] const std::optional<DelayStamps>& delays() const { return delays_; }

 private:
  std::optional<LinkState> state_;
  std::uint32_t sequence_ = 0;  ///< its header's
  SentCommands sent_;
  std::optional<DelayStamps> delays_;
};

}  // namespace pcavr
