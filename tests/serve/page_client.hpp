// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// A page without a browser. Boost.Beast takes long to compile: for one test and one benchmark only.
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/live_world.hpp"

#include "serve/server_message_reader.hpp"

namespace pcavr::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using tcp = boost::asio::ip::tcp;

inline tcp::endpoint local(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

/// A synchronous WebSocket client. Errors are returned as nullopt or false.
class PageClient {
 public:
  /// Connects, with the WebSocket handshake.
  /// `from` is the client's own address.
  explicit PageClient(std::uint16_t port, const std::string& origin = {},
                      const std::string& from = "127.0.0.1") {
    beast::error_code fault;
    socket_.next_layer().open(tcp::v4(), fault);
    if (!fault) socket_.next_layer().bind({asio::ip::make_address(from), 0}, fault);
    if (!fault) socket_.next_layer().connect(local(port), fault);
    if (!fault) socket_.next_layer().set_option(tcp::no_delay(true), fault);
    socket_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
      if (!origin.empty()) request.set(http::field::origin, origin);
    }));
    const std::string host = "127.0.0.1:" + std::to_string(port);
    if (!fault) socket_.handshake(host, "/live", fault);
    is_open = !fault;
    socket_.binary(true);
  }

  bool send(const std::vector<std::uint8_t>& bytes) {
    beast::error_code fault;
    socket_.write(asio::buffer(bytes), fault);
    return !fault;
  }
  template <typename Content>
  bool send_message(Content content) {
    return send(encode(PageMessage{{++last_sent, LiveWorld::clock()}, std::move(content)}));
  }
  bool send_hello() { return send_message(LiveHello{kLiveProtocolVersion, "test"}); }

  /// The next message; nullopt after the connection was closed.
  std::optional<ServerMessage> receive() {
    beast::flat_buffer buffer;
    beast::error_code fault;
    socket_.read(buffer, fault);
    if (fault) return std::nullopt;
    const auto bytes = buffer.cdata();
    auto message =
        decode_server_message({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if (!message) return std::nullopt;
    return std::move(*message);
  }
  /// The next message of one type.
  template <typename Content>
  std::optional<Content> receive_next() {
    while (const auto message = receive()) {
      if (const auto* content = std::get_if<Content>(&message->content)) return *content;
    }
    return std::nullopt;
  }
  void close() {
    beast::error_code ignored;
    socket_.close(websocket::close_code::normal, ignored);
  }
  /// A WebSocket's own ping.
  bool ping() {
    beast::error_code fault;
    socket_.ping({}, fault);
    return !fault;
  }
  tcp::socket& transport() { return socket_.next_layer(); }

  bool is_open = false;
  std::uint32_t last_sent = 0;

 private:
  asio::io_context io_;
  websocket::stream<tcp::socket> socket_{io_};
};

/// Sends the bytes and returns the response, until the connection is closed.
inline std::string response_to(std::uint16_t port, const std::string& bytes,
                               const std::string& from = "127.0.0.1") {
  asio::io_context io;
  tcp::socket socket(io);
  beast::error_code fault;
  socket.open(tcp::v4(), fault);
  socket.bind({asio::ip::make_address(from), 0}, fault);
  socket.connect(local(port), fault);
  asio::write(socket, asio::buffer(bytes), fault);
  std::string response;
  asio::read(socket, asio::dynamic_buffer(response), fault);
  return response;
}

}  // namespace pcavr::test
