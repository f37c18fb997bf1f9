// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Without Boost.Beast, which takes most of a minute to compile: streams.hpp has it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>

#include "pcavr/serve/server.hpp"

#include "http_handler.hpp"
#include "live_sessions.hpp"
#include "viewer_channels.hpp"

namespace pcavr::network {

namespace asio = boost::asio;
using boost::system::error_code;
using tcp = boost::asio::ip::tcp;

[[nodiscard]] inline std::chrono::nanoseconds duration_of(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

/// A WebSocket connection, over TLS or plain TCP.
class Client {
 public:
  virtual ~Client() = default;
  /// Sends the newest state if no message is in flight.
  virtual void tick(double now) = 0;
  /// Closes the connection after the queued messages.
  virtual void end() = 0;
};

/// The connection of a page.
class LivePage : public Client {
 public:
  virtual void send(std::vector<std::uint8_t> message) = 0;
};

/// State shared by all connections. For the network thread only, except `http_handler`.
struct Hub {
  Hub(const ServerOptions& server_options, PageWorld& world, const ContentSource& content,
      ViewerScene scene, std::unique_ptr<HttpHandler> handler)
      : options(server_options),
        http_handler(std::move(handler)),
        sessions(
            world,
            {.version = options.version,
             .is_replay = options.is_replay,
             .scene = options.scene,
             .objects = world.names(),
             .tool_radius = options.tool_radius,
             .rate = options.rate,
             .device = std::string(world.device_name())},
            [this](LiveSessions::PageId id, std::vector<std::uint8_t> message) {
              const auto page = pages.find(id);
              if (page != pages.end()) page->second->send(std::move(message));
            },
            options.tool_timeout, options.tool_idle_time),
        channels(world, content, std::move(scene)) {}

  ServerOptions options;
  std::unique_ptr<HttpHandler> http_handler;
  LiveSessions sessions;
  std::map<LiveSessions::PageId, LivePage*> pages;
  ViewerChannels channels;
  std::set<Client*> viewers;
  int connections = 0;
  std::map<std::string, int> connections_by_network;  ///< without those that have none
  std::map<std::string, int> pages_by_network;        ///< admitted ones, and viewers
  /// Declared after the above, so destroyed before: its pending handlers refer to them.
  asio::io_context io{1};
  /// Reads and compresses files; one thread, so that no file is compressed twice. Declared last, so
  /// destroyed first: pending requests own sockets of `io`.
  asio::thread_pool files{1};
};

/// RAII count of one more for a network.
class NetworkCount {
 public:
  NetworkCount(std::map<std::string, int>& counts, std::string network)
      : counts_(counts), network_(std::move(network)) {
    ++counts_[network_];
  }
  ~NetworkCount() {
    if (--counts_[network_] == 0) counts_.erase(network_);
  }
  NetworkCount(const NetworkCount&) = delete;
  NetworkCount& operator=(const NetworkCount&) = delete;

 private:
  std::map<std::string, int>& counts_;
  std::string network_;
};

/// The client that an address belongs to: an IPv6 client has a network of 64 bits.
[[nodiscard]] inline std::string network_of(const asio::ip::address& address) {
  if (!address.is_v6() || address.is_loopback()) return address.to_string();
  if (address.to_v6().is_v4_mapped()) {
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).to_string();
  }
  asio::ip::address_v6::bytes_type bytes = address.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), std::uint8_t{0});
  return asio::ip::address_v6(bytes).to_string() + "/64";
}

/// Admitted pages of one network, or of all.
[[nodiscard]] inline int pages_of(const Hub& hub, const std::string& network) {
  const auto found = hub.pages_by_network.find(network);
  return found == hub.pages_by_network.end() ? 0 : found->second;
}
[[nodiscard]] inline int pages_of(const Hub& hub) {
  int sum = 0;
  for (const auto& [network, count] : hub.pages_by_network) sum += count;
  return sum;
}

/// One network's share of `total`, at least one.
[[nodiscard]] inline int share_of(int total, const ServerOptions& options) {
  return std::max(1, static_cast<int>(std::ceil(total * options.max_address_share)));
}

/// RAII counter of the open connections.
class Connection {
 public:
  Connection(Hub& hub, std::string network)
      : hub_(hub), count_(hub.connections_by_network, std::move(network)) {
    ++hub_.connections;
  }
  ~Connection() { --hub_.connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

 private:
  Hub& hub_;
  NetworkCount count_;
};

/// The remote end of a connection, and its share of the connection count.
struct Peer {
  std::shared_ptr<Connection> connection;
  std::string address;
  std::string network;  ///< see network_of
  bool is_loopback = false;
};

}  // namespace pcavr::network
