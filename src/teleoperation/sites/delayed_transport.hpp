// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pcavr/teleoperation/link/link_conditions.hpp"
#include "pcavr/teleoperation/link/site_transport.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"

namespace pcavr {

/// The operator's end of the link with a simulated network between it and the real one: delay,
/// jitter, loss, reordering and rate in both directions. Times are the site's [s]. One thread.
class DelayedTransport {
 public:
  /// The reference is kept.
  DelayedTransport(OperatorTransport& transport, const SimulatedNetwork& network);

  void send(double now, const std::vector<std::uint8_t>& bytes);
  /// Passes on what has left by `now`.
  void transmit(double now);
  /// The next message that has arrived by `now`; empty: none.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> receive(double now);
  /// When a message arrives or leaves next; empty: none is under way.
  [[nodiscard]] std::optional<double> next_event() const;
  /// Messages that have not left yet.
  [[nodiscard]] std::size_t leaving() const { return leaving_.size(); }

 private:
  OperatorTransport& transport_;
  LinkConditions forward_;
  LinkConditions backward_;
  DelayedMessages<std::vector<std::uint8_t>> leaving_;
  DelayedMessages<std::vector<std::uint8_t>> arriving_;
};

}  // namespace pcavr
