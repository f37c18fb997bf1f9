// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "live_session.hpp"
#include "streams.hpp"
#include "viewer_session.hpp"

namespace pcavr::network {

inline constexpr std::uint32_t kMaxHeader = 16 * 1024;  // twice what browsers send with cookies
inline constexpr std::uint64_t kMaxBody = 4 * 1024;     // a pairing code is far shorter

/// The Content-Security-Policy of every response: a browser loads only this server's resources. The
/// page creates workers and textures from memory (blob:), and a decoder is WebAssembly.
inline constexpr char kPolicy[] =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "img-src 'self' data: blob:; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'self'; connect-src 'self' blob: ";

/// Handles one connection's requests in sequence; a WebSocket upgrade takes the connection over.
template <typename Stream>
class HttpSession final : public std::enable_shared_from_this<HttpSession<Stream>> {
 public:
  static constexpr bool kIsTls = std::is_same_v<Stream, TlsStream>;

  /// `redirects_to_https`: every response is a redirect to https.
  HttpSession(Hub& hub, Stream&& stream, beast::flat_buffer buffer, Peer peer,
              bool redirects_to_https)
      : hub_(hub),
        stream_(std::move(stream)),
        buffer_(std::move(buffer)),
        peer_(std::move(peer)),
        redirects_to_https_(redirects_to_https) {}

  void begin() {
    if constexpr (kIsTls) {
      beast::get_lowest_layer(stream_).expires_after(duration_of(hub_.options.read_timeout));
      stream_.async_handshake(
          asio::ssl::stream_base::server, buffer_.data(),
          [self = this->shared_from_this()](error_code fault, std::size_t used) {
            if (fault) return;
            self->buffer_.consume(used);
            self->read();
          });
    } else {
      read();
    }
  }

 private:
  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    parser_->body_limit(kMaxBody);
    beast::get_lowest_layer(stream_).expires_after(duration_of(hub_.options.read_timeout));
    http::async_read(stream_, buffer_, *parser_,
                     [self = this->shared_from_this()](error_code fault, std::size_t) {
                       self->on_request(fault);
                     });
  }

  void on_request(error_code fault) {
    if (fault) return respond_to(fault);
    const auto& request = parser_->get();
    HttpRequest plain = plain_request();
    keeps_alive_ = request.keep_alive();
    if (request.count(http::field::host) > 1) {  // [RFC 9112, 3.2]
      keeps_alive_ = false;
      return write(HttpHandler::error_response(400, "more than one Host header"));
    }
    if (redirects_to_https_) return write(hub_.http_handler->redirect_to_https(plain));
    if (!websocket::is_upgrade(request)) return fetch(std::move(plain));
    if (const auto rejected = hub_.http_handler->reject_upgrade(plain)) {
      keeps_alive_ = false;
      return write(*rejected);
    }
    if (!plain.viewer_protocol.empty()) {
      return std::make_shared<ViewerSession<Stream>>(hub_, std::move(stream_), std::move(peer_))
          ->open(request, plain.viewer_protocol);
    }
    std::make_shared<LiveSession<Stream>>(hub_, std::move(stream_), std::move(peer_))
        ->open(request);
  }

  void respond_to(error_code fault) {
    keeps_alive_ = false;
    if (fault == http::error::header_limit) {
      return write(HttpHandler::error_response(431, "the header exceeds 16 KiB"));
    }
    if (fault == http::error::body_limit) {
      return write(HttpHandler::error_response(413, "the body exceeds 4 KiB"));
    }
    const bool is_disconnected = fault == http::error::end_of_stream ||
                                 fault == http::error::partial_message ||
                                 fault == beast::error::timeout;
    // Only malformed HTTP gets a response.
    if (is_disconnected ||
        fault.category() != http::make_error_code(http::error::bad_method).category()) {
      return;
    }
    write(HttpHandler::error_response(400, "malformed HTTP request: " + fault.message()));
  }

  [[nodiscard]] HttpRequest plain_request() const {
    const auto& request = parser_->get();
    const auto field = [&](http::field name) { return std::string(request[name]); };
    HttpRequest plain;
    plain.method = std::string(request.method_string());
    plain.target = std::string(request.target());
    plain.host = field(http::field::host);
    plain.origin = field(http::field::origin);
    plain.cookie = field(http::field::cookie);
    plain.if_none_match = field(http::field::if_none_match);
    plain.accepts_gzip = field(http::field::accept_encoding).find("gzip") != std::string::npos;
    plain.body = request.body();
    plain.address = peer_.address;
    plain.is_loopback = peer_.is_loopback;
    plain.is_encrypted = kIsTls;
    plain.viewer_protocol = foxglove_protocol_in(field(http::field::sec_websocket_protocol));
    return plain;
  }

  /// Files are read and compressed on another thread, so that states are still sent. Ownership of
  /// the session moves there and back: a copy left there could destroy the session on that thread.
  void fetch(HttpRequest plain) {
    asio::post(hub_.files, [self = this->shared_from_this(), plain = std::move(plain)]() mutable {
      Hub& hub = self->hub_;
      HttpResponse response = hub.http_handler->respond(plain);
      asio::post(hub.io, [self = std::move(self), response = std::move(response)] {
        self->write(response);
      });
    });
  }

  void write(const HttpResponse& response) {
    content_ = response.content;
    const std::string_view body = content_ ? std::string_view(content_->body) : std::string_view();
    response_.emplace();
    response_->result(response.status);
    response_->version(11);
    response_->keep_alive(keeps_alive_);
    for (const auto& [name, value] : response.headers) response_->insert(name, value);
    if (content_) response_->set(http::field::content_type, content_->media_type);
    if (response.status != 304) response_->content_length(body.size());
    set_policy();
    const bool has_body = parser_->get().method() != http::verb::head && response.status != 304;
    response_->body() = {has_body ? body.data() : nullptr, has_body ? body.size() : 0};
    const double transfer = static_cast<double>(body.size()) / hub_.options.min_download_rate;
    beast::get_lowest_layer(stream_).expires_after(
        duration_of(hub_.options.response_timeout + transfer));
    http::async_write(stream_, *response_,
                      [self = this->shared_from_this()](error_code fault, std::size_t) {
                        self->on_written(fault);
                      });
  }

  void set_policy() {
    const std::string host(parser_->get()[http::field::host]);
    // Older browsers do not match a WebSocket of the same origin by 'self'. The host was checked.
    const bool is_plain = host.find_first_of(" ;,'\"\r\n") == std::string::npos;
    response_->set("Content-Security-Policy",
                   kPolicy + (is_plain ? (kIsTls ? "wss://" : "ws://") + host : std::string()));
    response_->set("X-Content-Type-Options", "nosniff");
    response_->set("Referrer-Policy", "no-referrer");
    response_->set("Cross-Origin-Resource-Policy", "same-origin");
    response_->set("Cross-Origin-Opener-Policy", "same-origin");
  }

  void on_written(error_code fault) {
    content_.reset();
    if (fault) return;
    if (keeps_alive_) return read();
    error_code ignored;
    socket_of(stream_).shutdown(tcp::socket::shutdown_send, ignored);
  }

  Hub& hub_;
  Stream stream_;
  beast::flat_buffer buffer_;
  Peer peer_;
  bool redirects_to_https_;
  bool keeps_alive_ = false;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::span_body<const char>>> response_;
  std::shared_ptr<const Content> content_;  ///< keeps the body alive while it is written
};

}  // namespace pcavr::network
