// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>

#include <zmq.hpp>

namespace pcavr {

/// Events of a socket's connections. One per context.
class SocketMonitor {
 public:
  SocketMonitor(zmq::context_t& context, zmq::socket_t& socket, int events)
      : receiver_(context, zmq::socket_type::pair) {
    constexpr char kAddress[] = "inproc://pcavr-monitor";
    zmq_socket_monitor(socket.handle(), kAddress, events);
    receiver_.set(zmq::sockopt::linger, 0);
    receiver_.connect(kAddress);
  }
  struct Event {
    std::uint16_t event = 0;
    std::uint32_t value = 0;
  };
  /// Waits for one, at most `timeout` [ms].
  [[nodiscard]] std::optional<Event> next(int timeout = 0) {
    receiver_.set(zmq::sockopt::rcvtimeo, timeout);
    zmq::message_t number;
    zmq::message_t address;
    try {
      if (!receiver_.recv(number)) return std::nullopt;
      if (number.more()) static_cast<void>(receiver_.recv(address));
    } catch (const zmq::error_t&) {
      return std::nullopt;  // a signal
    }
    Event event;
    if (number.size() < sizeof event.event + sizeof event.value) return std::nullopt;
    std::memcpy(&event.event, number.data(), sizeof event.event);
    std::memcpy(&event.value, number.data<std::uint8_t>() + sizeof event.event, sizeof event.value);
    return event;
  }

 private:
  zmq::socket_t receiver_;
};

}  // namespace pcavr
