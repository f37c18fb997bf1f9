// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/link/site_transport.hpp"

#include "connection_faults.hpp"

namespace pcavr {

/// An operator's site until the robot's site has answered: when to say hello, and when to give up.
/// Times are the site's [s].
class ConnectionAttempt {
 public:
  /// `timeout` [s] for the first session; later ones are waited for.
  explicit ConnectionAttempt(double timeout) : timeout_(timeout) {}

  void begin(double now) { next_hello_ = now; }
  [[nodiscard]] bool is_hello_due(double now) {
    if (now < next_hello_) return false;
    next_hello_ = now + kHelloInterval;
    return true;
  }
  /// Another operator's site is connected: perhaps this operator's last session, which ends soon.
  /// `text`: what the robot's site says of it.
  void on_busy(const std::string& text) { busy_ = text; }
  void on_connected() { has_connected_ = true; }
  [[nodiscard]] std::optional<Error> find_fault(OperatorTransport::State state, double now) const {
    if (has_connected_) return std::nullopt;  // an interruption: waits for the robot's site
    if (state == OperatorTransport::State::rejected) return key_not_accepted();
    if (now < timeout_) return std::nullopt;
    return not_connected(state, busy_);
  }

 private:
  // [s] Far below the robot site's timeout: a burst of losses must not end a session that begins.
  static constexpr double kHelloInterval = 0.02;

  double timeout_;
  double next_hello_ = 0.0;
  bool has_connected_ = false;
  std::optional<std::string> busy_ = {};
};

}  // namespace pcavr
