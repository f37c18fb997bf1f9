// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "delayed_transport.hpp"

#include <algorithm>
#include <utility>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// Into the simulated network: lost, once or twice.
void pass(LinkConditions& conditions, double now, std::vector<std::uint8_t> bytes,
          DelayedMessages<std::vector<std::uint8_t>>& to) {
  const LinkConditions::Arrivals arrivals = conditions.arrivals(now, bytes.size());
  if (arrivals.second) to.push(*arrivals.second, bytes);
  if (arrivals.first) to.push(*arrivals.first, std::move(bytes));
}

}  // namespace

DelayedTransport::DelayedTransport(OperatorTransport& transport, const SimulatedNetwork& network)
    : transport_(transport),
      forward_(network.forward, Random(network.seed).fork(2)),
      backward_(network.backward, Random(network.seed).fork(1)) {}

void DelayedTransport::send(double now, const std::vector<std::uint8_t>& bytes) {
  pass(forward_, now, bytes, leaving_);
}

void DelayedTransport::transmit(double now) {
  while (const auto bytes = leaving_.pop(now)) transport_.send(*bytes);
}

std::optional<std::vector<std::uint8_t>> DelayedTransport::receive(double now) {
  while (auto bytes = transport_.receive()) pass(backward_, now, std::move(*bytes), arriving_);
  return arriving_.pop(now);
}

std::optional<double> DelayedTransport::next_event() const {
  const std::optional<double> arrival = arriving_.next_arrival();
  const std::optional<double> leaving = leaving_.next_arrival();
  if (!arrival || !leaving) return arrival ? arrival : leaving;
  return std::min(*arrival, *leaving);
}

}  // namespace pcavr
