// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/link/link_clock.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "delayed_transport.hpp"
#include "site_log.hpp"

namespace pcavr {

/// The messages of an operator's site and of the session they belong to: numbers them, discards
/// those of other sessions, measures the shared clock by round trips. Times are the site's [s]. One
/// thread.
class OperatorConnection {
 public:
  /// The references are kept. `new_session` draws the number of a session, never 0.
  OperatorConnection(OperatorTransport& client, const SimulatedNetwork& network, SiteLog& log,
                     const SiteClock& clock, std::function<std::uint32_t()> new_session);

  /// Another session, whose clock is not known yet; nothing of this one is received any more.
  void restart();

  template <typename Content>
  void send(Content&& content) {
    message_.content = std::forward<Content>(content);
    send_message();
  }
  /// A round trip, unless the last began less than `interval` [s] ago.
  void ping(double now, double interval);
  void transmit() { network_.transmit(clock_.now()); }
  /// The next message of this session, or the next rejection; empty if there is none. Answers to
  /// `ping` stay here. An Error if the robot's site speaks another version.
  [[nodiscard]] Expected<std::optional<LinkMessage>> receive();
  /// When a message arrives or leaves a simulated network next.
  [[nodiscard]] std::optional<double> next_event() const { return network_.next_event(); }
  /// Waits for what is still in the simulated network, and for the socket's own thread.
  void flush();

  [[nodiscard]] std::uint32_t session() const { return session_; }
  /// Time since the last message of a session [s].
  [[nodiscard]] double silence(double now) const { return now - last_received_; }
  [[nodiscard]] const LinkClock& shared_clock() const { return shared_clock_; }
  [[nodiscard]] std::size_t round_trips() const { return round_trips_; }
  /// Statistics of the clock, which must be known. `lead` [s] of the commands.
  [[nodiscard]] LinkStatistics statistics(double now, double lead) const;
  /// Adds its invalid messages, and the clock once that is known.
  void add_to(OperatorSiteReport& report) const;

 private:
  void send_message();
  [[nodiscard]] bool is_for_this_session(const LinkMessage& message, double now);

  OperatorTransport& client_;
  SiteLog& log_;
  const SiteClock& clock_;
  std::function<std::uint32_t()> new_session_;
  DelayedTransport network_;
  std::uint32_t session_;
  std::uint32_t sequence_ = 0;
  std::uint32_t newest_received_ = 0;  ///< sequence number in this session
  double last_received_;
  double next_ping_ = 0.0;
  LinkClock shared_clock_;
  std::size_t round_trips_ = 0;
  std::size_t invalid_messages_ = 0;
  LinkMessage message_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace pcavr
