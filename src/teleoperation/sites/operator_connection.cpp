// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "operator_connection.hpp"

#include <random>
#include <variant>

#include "connection_faults.hpp"
#include "site_reporter.hpp"

namespace pcavr {
namespace {

constexpr double kFlushWait = 0.002;   // [s]
constexpr double kMaxFlush = 2.0;      // [s] of a simulated network, at the end
constexpr double kCloseTimeout = 0.2;  // [s] until the last message has left

std::uint32_t random_session() {
  // Sessions of different processes must differ; nothing is computed from it.
  std::uint32_t session = 0;
  while (session == 0) session = std::random_device{}();
  return session;
}

}  // namespace

OperatorConnection::OperatorConnection(OperatorTransport& client, const SimulatedNetwork& network,
                                       SiteLog& log, const SiteClock& clock,
                                       std::function<std::uint32_t()> new_session)
    : client_(client),
      log_(log),
      clock_(clock),
      new_session_(new_session ? std::move(new_session) : random_session),
      network_(client, network),
      session_(new_session_()),
      last_received_(clock.now()) {}

void OperatorConnection::restart() {
  session_ = new_session_();
  newest_received_ = 0;
  shared_clock_ = {};
  round_trips_ = 0;
}

void OperatorConnection::send_message() {
  const double now = clock_.now();
  message_.header = {++sequence_, session_, now};
  encode_link_message(message_, bytes_);
  if (SiteReporter::is_logged(message_)) log_.on_sent(now, bytes_);
  network_.send(now, bytes_);
}

void OperatorConnection::ping(double now, double interval) {
  if (now < next_ping_) return;
  next_ping_ = now + interval;
  send(LinkPing{});
}

Expected<std::optional<LinkMessage>> OperatorConnection::receive() {
  while (const auto bytes = network_.receive(clock_.now())) {
    const double now = clock_.now();
    Expected<LinkMessage> message = decode_link_message(*bytes);
    if (!message) {
      ++invalid_messages_;
      const std::optional<int> version = link_version_of(*bytes);
      if (version && *version != kLinkVersion) return other_link_version(*version);
      continue;
    }
    if (SiteReporter::is_logged(*message)) log_.on_received(now, *bytes);
    if (!is_for_this_session(*message, now)) continue;
    if (const auto* pong = std::get_if<LinkPong>(&message->content)) {
      shared_clock_.add({pong->sent, pong->received, message->header.clock, now});
      ++round_trips_;
      continue;
    }
    return std::optional(std::move(*message));
  }
  return std::optional<LinkMessage>();
}

bool OperatorConnection::is_for_this_session(const LinkMessage& message, double now) {
  const bool is_rejection = std::holds_alternative<LinkReject>(message.content);
  const LinkHeader& header = message.header;
  if (header.session != session_) return is_rejection && header.session == 0;
  if (!is_rejection && header.sequence > newest_received_) {  // a repetition shows nothing
    newest_received_ = header.sequence;
    last_received_ = now;
  }
  return true;
}

LinkStatistics OperatorConnection::statistics(double now, double lead) const {
  return {.clock_offset = shared_clock_.shared_at(now) - now,
          .clock_std = shared_clock_.std(),
          .round_trip = shared_clock_.min_delay(),
          .delay_variation = shared_clock_.delay_variation(),
          .lead = lead};
}

void OperatorConnection::add_to(OperatorSiteReport& report) const {
  report.invalid_messages += invalid_messages_;
  if (!shared_clock_.is_known()) return;
  const double now = clock_.now();
  report.round_trip = shared_clock_.min_delay();
  report.clock_offset = shared_clock_.shared_at(now) - now;
  report.clock_drift = shared_clock_.drift();
  report.clock_std = shared_clock_.std();
}

void OperatorConnection::flush() {
  const double end = clock_.now() + kMaxFlush;
  while (network_.leaving() > 0 && clock_.now() < end) {
    client_.wait(kFlushWait);
    transmit();
  }
  client_.close(kCloseTimeout);
}

}  // namespace pcavr
