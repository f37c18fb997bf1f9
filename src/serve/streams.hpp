// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Boost.Beast takes most of a minute to compile: only plain_session.cpp and tls_session.cpp may
// include this header and those that include it.
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include "network.hpp"

namespace pcavr::network {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;

[[nodiscard]] inline tcp::socket& socket_of(PlainStream& stream) { return stream.socket(); }
[[nodiscard]] inline tcp::socket& socket_of(TlsStream& stream) {
  return stream.next_layer().socket();
}

/// Limits and timeouts of a WebSocket, before it is accepted.
template <typename Stream>
void set_up(websocket::stream<Stream>& socket, const ServerOptions& options) {
  beast::get_lowest_layer(socket).expires_never();
  error_code ignored;
  tcp::socket& transport = beast::get_lowest_layer(socket).socket();
  transport.set_option(tcp::no_delay(true), ignored);
  transport.set_option(asio::socket_base::send_buffer_size(options.send_buffer), ignored);
  websocket::stream_base::timeout limits{};
  limits.handshake_timeout = duration_of(options.handshake_timeout);
  limits.idle_timeout = duration_of(options.idle_timeout);
  limits.keep_alive_pings = true;
  socket.set_option(limits);
  socket.read_message_max(kMaxLiveMessageBytes);
  socket.auto_fragment(false);
  socket.binary(true);
}

}  // namespace pcavr::network
