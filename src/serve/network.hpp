// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Boost.Beast takes most of a minute to compile: only server.cpp includes this, and what builds on
// it.
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include "pcavr/serve/server.hpp"

#include "front_desk.hpp"
#include "live_room.hpp"

namespace pcavr::network {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;
using tcp = boost::asio::ip::tcp;
using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;

/// A page's connection, whatever it goes over.
class LivePage {
 public:
  virtual ~LivePage() = default;
  virtual void send(std::vector<std::uint8_t> message) = 0;
  /// Sends the newest state if the last message is on its way.
  virtual void tick(double now) = 0;
  /// After what is still to be said.
  virtual void end() = 0;
};

/// What all connections share. The network's thread only, but for the desk.
struct Hub {
  Hub(const ServerOptions& server_options, LiveWorld& world, std::unique_ptr<FrontDesk> front_desk)
      : options(server_options),
        desk(std::move(front_desk)),
        room(world,
             {.version = options.version,
              .is_replay = options.is_replay,
              .scene = options.scene,
              .objects = world.names(),
              .tool_radius = options.tool_radius,
              .rate = options.rate,
              .device = std::string(world.device_name())},
             [this](LiveRoom::PageId id, std::vector<std::uint8_t> message) {
               const auto page = pages.find(id);
               if (page != pages.end()) page->second->send(std::move(message));
             }) {}

  ServerOptions options;
  std::unique_ptr<FrontDesk> desk;
  LiveRoom room;
  std::map<LiveRoom::PageId, LivePage*> pages;
  std::size_t connections = 0;
  /// After all of the above: what it holds at the end refers to that.
  asio::io_context io{1};
  /// Reads and packs files; one thread, so that two never do the same work. Last, and so ended
  /// first: whoever still waits for a file has a socket of `io`.
  asio::thread_pool files{1};
};

/// Counts a connection for as long as it lives.
class Connection {
 public:
  explicit Connection(Hub& hub) : hub_(hub) { ++hub_.connections; }
  ~Connection() { --hub_.connections; }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

 private:
  Hub& hub_;
};

/// Where a connection comes from, and its place in the count.
struct Peer {
  std::shared_ptr<Connection> connection;
  std::string address;
  bool is_loopback = false;
};

[[nodiscard]] inline tcp::socket& socket_of(PlainStream& stream) { return stream.socket(); }
[[nodiscard]] inline tcp::socket& socket_of(TlsStream& stream) {
  return stream.next_layer().socket();
}

}  // namespace pcavr::network
