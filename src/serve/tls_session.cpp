// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <utility>

#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/detect_ssl.hpp>

#include "http_session.hpp"
#include "redirecting_session.hpp"
#include "session.hpp"

namespace pcavr::network {
namespace {

/// Detects by the first bytes whether a client on a TLS port uses TLS or plain HTTP.
class TlsDetector final : public std::enable_shared_from_this<TlsDetector> {
 public:
  TlsDetector(Hub& hub, asio::ssl::context& tls, tcp::socket&& socket, Peer peer)
      : hub_(hub), tls_(tls), stream_(std::move(socket)), peer_(std::move(peer)) {}

  void detect() {
    stream_.expires_after(duration_of(hub_.options.read_timeout));
    beast::async_detect_ssl(stream_, buffer_,
                            [self = shared_from_this()](error_code fault, bool is_tls) {
                              if (!fault) self->start_session(is_tls);
                            });
  }

 private:
  void start_session(bool is_tls) {
    if (!is_tls) {
      return begin_redirecting_session(hub_, std::move(stream_), std::move(buffer_),
                                       std::move(peer_));
    }
    std::make_shared<HttpSession<TlsStream>>(hub_, TlsStream(std::move(stream_), tls_),
                                             std::move(buffer_), std::move(peer_), false)
        ->begin();
  }

  Hub& hub_;
  asio::ssl::context& tls_;
  PlainStream stream_;
  Peer peer_;
  beast::flat_buffer buffer_;
};

}  // namespace

void begin_tls_session(Hub& hub, asio::ssl::context& tls, tcp::socket socket, Peer peer) {
  std::make_shared<TlsDetector>(hub, tls, std::move(socket), std::move(peer))->detect();
}

}  // namespace pcavr::network
