// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// A page without a browser. Boost.Beast takes long to compile: one test source, and one benchmark.
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

namespace pcavr::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using tcp = boost::asio::ip::tcp;

inline tcp::endpoint local(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

/// One WebSocket, waited for. Faults come back as nothing, or false.
class PageClient {
 public:
  /// Connects and shakes hands.
  explicit PageClient(std::uint16_t port, const std::string& origin = {}) {
    beast::error_code fault;
    socket_.next_layer().connect(local(port), fault);
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
  bool say(Content content) {
    return send(encode(PageMessage{{++said, LiveWorld::clock()}, std::move(content)}));
  }
  bool greet() { return say(LiveHello{kLiveProtocol, "test"}); }

  /// The next message; nothing where the connection ended.
  std::optional<ServerMessage> hear() {
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
  /// The next of one kind.
  template <typename Content>
  std::optional<Content> hear_a() {
    while (const auto message = hear()) {
      if (const auto* content = std::get_if<Content>(&message->content)) return *content;
    }
    return std::nullopt;
  }
  void close() {
    beast::error_code ignored;
    socket_.close(websocket::close_code::normal, ignored);
  }
  tcp::socket& transport() { return socket_.next_layer(); }

  bool is_open = false;
  std::uint32_t said = 0;

 private:
  asio::io_context io_;
  websocket::stream<tcp::socket> socket_{io_};
};

/// What comes back for these bytes, to the end of the connection.
inline std::string answer_to(std::uint16_t port, const std::string& bytes) {
  asio::io_context io;
  tcp::socket socket(io);
  beast::error_code fault;
  socket.connect(local(port), fault);
  asio::write(socket, asio::buffer(bytes), fault);
  std::string answer;
  asio::read(socket, asio::dynamic_buffer(answer), fault);
  return answer;
}

}  // namespace pcavr::test
