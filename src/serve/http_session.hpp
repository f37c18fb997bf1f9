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
#include "network.hpp"

namespace pcavr::network {

inline constexpr auto kMaxReadTime = std::chrono::seconds(20);
inline constexpr auto kMaxWriteTime = std::chrono::seconds(30);
/// [bytes/s] a file may go as slowly as that.
inline constexpr std::size_t kSlowest = 64 * 1024;
inline constexpr std::uint32_t kMaxHeader = 16 * 1024;
inline constexpr std::uint64_t kMaxBody = 4 * 1024;

/// What every answer says, so that a browser holds the page to what is its own. The page makes
/// workers and textures of what it holds in memory (blob:), and a decoder is WebAssembly.
inline constexpr char kPolicy[] =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'self'; connect-src 'self' blob: ";

/// One connection's requests, one after the other; a WebSocket takes the connection over.
template <typename Stream>
class HttpSession final : public std::enable_shared_from_this<HttpSession<Stream>> {
 public:
  static constexpr bool kIsTls = std::is_same_v<Stream, TlsStream>;

  /// `sends_to_tls`: whatever is asked, the answer is to ask over TLS.
  HttpSession(Hub& hub, Stream&& stream, beast::flat_buffer buffer, Peer peer, bool sends_to_tls)
      : hub_(hub),
        stream_(std::move(stream)),
        buffer_(std::move(buffer)),
        peer_(std::move(peer)),
        sends_to_tls_(sends_to_tls) {}

  void begin() {
    if constexpr (kIsTls) {
      beast::get_lowest_layer(stream_).expires_after(kMaxReadTime);
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
    beast::get_lowest_layer(stream_).expires_after(kMaxReadTime);
    http::async_read(stream_, buffer_, *parser_,
                     [self = this->shared_from_this()](error_code fault, std::size_t) {
                       self->on_request(fault);
                     });
  }

  void on_request(error_code fault) {
    if (fault) return refuse(fault);
    const auto& request = parser_->get();
    HttpRequest asked = plain_request();
    keeps_alive_ = request.keep_alive();
    if (sends_to_tls_) return write(FrontDesk::send_to_tls(asked));
    if (!websocket::is_upgrade(request)) return fetch(std::move(asked));
    if (const auto refused = hub_.desk->refuse_live(asked)) {
      keeps_alive_ = false;
      return write(*refused);
    }
    std::make_shared<LiveSession<Stream>>(hub_, std::move(stream_), std::move(peer_))
        ->open(request);
  }

  void refuse(error_code fault) {
    keeps_alive_ = false;
    if (fault == http::error::header_limit) {
      return write(FrontDesk::refusal(431, "the header is longer than 16 KiB"));
    }
    if (fault == http::error::body_limit) {
      return write(FrontDesk::refusal(413, "the body is longer than 4 KiB"));
    }
    const bool is_gone = fault == http::error::end_of_stream ||
                         fault == http::error::partial_message || fault == beast::error::timeout;
    // Only what came and is no HTTP gets an answer.
    if (is_gone || fault.category() != http::make_error_code(http::error::bad_method).category()) {
      return;
    }
    write(FrontDesk::refusal(400, "not HTTP: " + fault.message()));
  }

  [[nodiscard]] HttpRequest plain_request() const {
    const auto& request = parser_->get();
    const auto field = [&](http::field name) { return std::string(request[name]); };
    HttpRequest asked;
    asked.method = std::string(request.method_string());
    asked.target = std::string(request.target());
    asked.host = field(http::field::host);
    asked.origin = field(http::field::origin);
    asked.cookie = field(http::field::cookie);
    asked.known_tag = field(http::field::if_none_match);
    asked.accepts_gzip = field(http::field::accept_encoding).find("gzip") != std::string::npos;
    asked.body = request.body();
    asked.address = peer_.address;
    asked.is_loopback = peer_.is_loopback;
    asked.is_encrypted = kIsTls;
    return asked;
  }

  /// Files are read and packed elsewhere: states go out meanwhile. The session itself goes there
  /// and back: were it still held there, it could end on that thread.
  void fetch(HttpRequest asked) {
    asio::post(hub_.files, [self = this->shared_from_this(), asked = std::move(asked)]() mutable {
      Hub& hub = self->hub_;
      HttpAnswer answer = hub.desk->answer(asked);
      asio::post(hub.io,
                 [self = std::move(self), answer = std::move(answer)] { self->write(answer); });
    });
  }

  void write(const HttpAnswer& answer) {
    content_ = answer.content;
    const std::string_view body = content_ ? std::string_view(content_->body) : std::string_view();
    response_.emplace();
    response_->result(answer.status);
    response_->version(11);
    response_->keep_alive(keeps_alive_);
    for (const auto& [name, value] : answer.headers) response_->insert(name, value);
    if (content_) response_->set(http::field::content_type, content_->media_type);
    if (answer.status != 304) response_->content_length(body.size());
    set_policy();
    const bool has_body = parser_->get().method() != http::verb::head && answer.status != 304;
    response_->body() = {has_body ? body.data() : nullptr, has_body ? body.size() : 0};
    beast::get_lowest_layer(stream_).expires_after(kMaxWriteTime +
                                                   std::chrono::seconds(body.size() / kSlowest));
    http::async_write(stream_, *response_,
                      [self = this->shared_from_this()](error_code fault, std::size_t) {
                        self->on_written(fault);
                      });
  }

  void set_policy() {
    const std::string host(parser_->get()[http::field::host]);
    // Older browsers do not count a WebSocket to the same place as 'self'. The host was checked.
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
  bool sends_to_tls_;
  bool keeps_alive_ = false;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::span_body<const char>>> response_;
  std::shared_ptr<const Content> content_;  ///< what is being written
};

}  // namespace pcavr::network
