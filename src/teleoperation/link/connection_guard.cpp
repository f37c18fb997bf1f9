// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "connection_guard.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <arpa/inet.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace pcavr {
namespace {

// [ms] Interval between two looks at the connections: at a gigabit per second a megabyte arrives in
// 8.
constexpr int kGuardPoll = 10;
constexpr double kReportInterval = 10.0;  // [s] between two lines about silent connections
constexpr std::size_t kNetworkBytes = 8;  // of an IPv6 address: what one subscriber has

/// The peer's address without the port; its network for IPv6. Empty if the peer is gone.
std::string address_of(int descriptor) {
  sockaddr_storage peer{};
  socklen_t size = sizeof peer;
  if (::getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &size) != 0) return {};
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* address = nullptr;
  if (peer.ss_family == AF_INET) {
    address = &reinterpret_cast<sockaddr_in*>(&peer)->sin_addr;
  } else if (peer.ss_family == AF_INET6) {
    in6_addr& whole = reinterpret_cast<sockaddr_in6*>(&peer)->sin6_addr;
    if (IN6_IS_ADDR_V4MAPPED(&whole) == 0) {
      std::fill(std::begin(whole.s6_addr) + kNetworkBytes, std::end(whole.s6_addr), 0);
    }
    address = &whole;
  }
  if (address == nullptr) return {};
  if (::inet_ntop(peer.ss_family, address, text.data(), text.size()) == nullptr) return {};
  return text.data();
}

/// Received by this machine so far, with what libzmq has not read yet.
std::uint64_t received_bytes(int descriptor) {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return 0;
  return info.tcpi_bytes_received;
}

}  // namespace

ConnectionGuard::ConnectionGuard(zmq::context_t& context, zmq::socket_t& listener, bool has_keys)
    : monitor_(context, listener,
               ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                   ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL),
      has_keys_(has_keys),
      thread_([this] { run(); }) {}

ConnectionGuard::~ConnectionGuard() {
  is_ending_ = true;
  thread_.join();
}

void ConnectionGuard::run() {
  double next_check = 0.0;
  while (!is_ending_) {
    const std::optional<SocketMonitor::Event> event = monitor_.next(kGuardPoll);
    const double t = steady_seconds();
    if (event) on_event(*event, t);
    // A flood of connections brings events without a pause.
    if (connections_.size() > kMaxSilentOfAddress) limit_silent();
    if (event && t < next_check) continue;
    next_check = t + 1e-3 * kGuardPoll;
    check(t);
  }
}

void ConnectionGuard::on_event(const SocketMonitor::Event& event, double now) {
  const int descriptor = static_cast<int>(event.value);
  if (event.event == ZMQ_EVENT_ACCEPTED) return accept(descriptor, now);
  if (event.event == ZMQ_EVENT_DISCONNECTED) {
    connections_.erase(descriptor);
    return;
  }
  notices_.add(has_keys_ ? "rejected a connection: no key, or made for another site's key"
                         : "rejected a connection: it uses a key, but this site has none");
}

void ConnectionGuard::accept(int descriptor, double now) {
  connections_[descriptor] = {
      .address = address_of(descriptor),
      .since = now,
      .messages = messages_[slot_of(descriptor)].load(std::memory_order_relaxed)};
}

void ConnectionGuard::check(double now) {
  check_messages();
  for (auto next = connections_.begin(); next != connections_.end();) {
    const auto connection = next++;
    if (connection->second.is_silent && now - connection->second.since > kMaxSilence) {
      ++closed_silent_;
      close(connection);
    }
  }
  report_silent(now);
}

void ConnectionGuard::check_messages() {
  // A message that waits for a busy receiver is no fault of its sender.
  const std::uint32_t drained = drained_.load(std::memory_order_relaxed);
  const bool is_drained = std::exchange(seen_drained_, drained) != drained;
  for (auto next = connections_.begin(); next != connections_.end();) {
    const auto connection = next++;
    auto& [descriptor, known] = *connection;
    const std::uint32_t messages = messages_[slot_of(descriptor)].load(std::memory_order_relaxed);
    const std::uint64_t bytes = received_bytes(descriptor);
    if (messages != known.messages) {
      known.messages = messages;
      known.is_silent = false;
      known.bytes_then = bytes;
    } else if (is_drained && bytes > known.bytes_then + kMaxIncomplete) {
      notices_.add("ended the connection from " + known.address +
                   ": more than a megabyte, and no whole message");
      close(connection);
    }
  }
}

/// The address with the most of them loses its oldest one, so that none can keep out the others.
void ConnectionGuard::limit_silent() {
  while (true) {
    std::map<std::string, std::size_t> counts;
    std::size_t silent = 0;
    for (const auto& [descriptor, known] : connections_) {
      if (!known.is_silent) continue;
      ++counts[known.address];
      ++silent;
    }
    const auto most =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == counts.end()) return;
    if (silent <= kMaxSilent && most->second <= kMaxSilentOfAddress) return;
    auto oldest = connections_.end();
    for (auto one = connections_.begin(); one != connections_.end(); ++one) {
      if (!one->second.is_silent || one->second.address != most->first) continue;
      if (oldest == connections_.end() || one->second.since < oldest->second.since) oldest = one;
    }
    ++closed_silent_;
    close(oldest);
  }
}

/// libzmq sees the end of the stream, and closes the descriptor itself.
void ConnectionGuard::close(Connections::iterator connection) {
  ::shutdown(connection->first, SHUT_RDWR);
  connections_.erase(connection);
}

void ConnectionGuard::report_silent(double now) {
  if (closed_silent_ == 0 || now < next_report_) return;
  next_report_ = now + kReportInterval;
  notices_.add("ended " + std::to_string(std::exchange(closed_silent_, 0)) +
               " connections that had sent no message");
}

}  // namespace pcavr
