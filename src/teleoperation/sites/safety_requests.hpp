// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/operator_interface.hpp"

namespace pcavr {

/// The operator's stops and holds, repeated until the robot's state agrees. A release or a resume
/// that was not confirmed is not carried into another session: there it has to be wanted anew.
class SafetyRequests {
 public:
  void add(const OperatorRequests& wanted, double now) {
    if (wanted.is_stopped) wanted_.is_stopped = wanted.is_stopped;
    if (wanted.is_on_hold) wanted_.is_on_hold = wanted.is_on_hold;
    if (wanted.is_stopped || wanted.is_on_hold) next_ = now;
  }

  void drop_releases() {
    if (wanted_.is_stopped == false) wanted_.is_stopped.reset();
    if (wanted_.is_on_hold == false) wanted_.is_on_hold.reset();
  }

  /// Requests to be sent now; `state`: the robot's newest, if known.
  [[nodiscard]] std::vector<LinkStop> due(const LinkState* state, double now) {
    if (now < next_) return {};
    next_ = now + kInterval;
    if (state != nullptr && wanted_.is_stopped == state->is_stopped) wanted_.is_stopped.reset();
    if (state != nullptr && wanted_.is_on_hold == state->is_on_hold) wanted_.is_on_hold.reset();
    std::vector<LinkStop> stops;
    if (wanted_.is_stopped) {
      stops.push_back(*wanted_.is_stopped ? LinkStop::emergency_stop : LinkStop::reset);
    }
    if (wanted_.is_on_hold) {
      stops.push_back(*wanted_.is_on_hold ? LinkStop::hold : LinkStop::resume);
    }
    return stops;
  }

 private:
  static constexpr double kInterval = 0.02;  // [s] between two of the same

  OperatorRequests wanted_;  ///< and not yet confirmed
  double next_ = 0.0;        ///< [s]
};

}  // namespace pcavr
