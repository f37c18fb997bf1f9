// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "streams.hpp"

namespace pcavr::network {

/// One page's WebSocket. Backpressure: at most one message is in flight, and a state is only
/// encoded when it can be sent at once.
template <typename Stream>
class LiveSession final : public LivePage,
                          public std::enable_shared_from_this<LiveSession<Stream>> {
 public:
  LiveSession(Hub& hub, Stream&& stream, Peer peer)
      : hub_(hub), peer_(std::move(peer)), socket_(std::move(stream)), page_(hub.sessions.join()) {
    hub_.pages.emplace(page_, this);
  }
  ~LiveSession() override {
    hub_.pages.erase(page_);
    hub_.sessions.leave(page_);
  }

  template <typename Request>
  void open(const Request& request) {
    set_up(socket_, hub_.options);
    // Beast replies to pings while it reads, without the pause of the rate limit.
    socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind == websocket::frame_type::ping &&
          ++pings_since_tick_ > hub_.options.max_messages_per_tick) {
        drop();
      }
    });
    socket_.async_accept(request, [self = this->shared_from_this()](error_code fault) {
      if (!fault) self->begin();
    });
  }

  void send(std::vector<std::uint8_t> message) override {
    if (std::ssize(queue_) >= hub_.options.max_queued_messages) return drop();
    queue_.push_back(std::move(message));
    write_next();
  }

  void tick(double now) override {
    received_since_tick_ = 0;
    pings_since_tick_ = 0;
    if (const auto self = std::exchange(paused_self_, nullptr)) read();
    if (is_writing_) {
      if (now - write_began_ > hub_.options.max_write_time) drop();
      return;
    }
    if (!is_open_ || is_ending_) return;
    if (!hub_.sessions.has_sent_hello(page_)) {
      if (now - opened_ > hub_.options.hello_timeout) drop();
      return;
    }
    hub_.sessions.write_state(page_, now, last_write_, message_);
    write(now);
  }

  void end() override {
    is_ending_ = true;
    write_next();
    paused_self_.reset();
  }

 private:
  void begin() {
    is_open_ = true;
    opened_ = LiveWorld::clock();
    const ServerOptions& options = hub_.options;
    // Only admitted pages count: one that is being rejected may take long to close.
    const int max_of_network = share_of(options.max_pages, options);
    if (pages_of(hub_, peer_.network) >= max_of_network) {
      return reject(std::to_string(max_of_network) +
                    " pages are open from this address, which is the limit");
    }
    if (pages_of(hub_) >= options.max_pages) {
      return reject(std::to_string(options.max_pages) + " pages are open, which is the limit");
    }
    place_.emplace(hub_.pages_by_network, peer_.network);
    read();
  }

  void reject(std::string reason) {
    queue_.push_back(encode(
        ServerMessage{{1, LiveWorld::clock()}, LiveNotice{LiveLevel::error, std::move(reason)}}));
    end();
  }

  void read() {
    if (received_since_tick_ >= hub_.options.max_messages_per_tick) {
      // No read is pending, so this is the only reference to the session.
      paused_self_ = this->shared_from_this();
      return;
    }
    socket_.async_read(buffer_, [self = this->shared_from_this()](error_code fault, std::size_t) {
      if (!fault) self->on_message();
    });
  }

  void on_message() {
    ++received_since_tick_;
    const auto bytes = buffer_.cdata();
    const bool keeps_open =
        !is_ending_ && hub_.sessions.on_message(
                           page_, {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                           LiveWorld::clock());
    buffer_.consume(buffer_.size());
    if (!keeps_open) return end();
    read();
  }

  void write_next() {
    if (!is_open_ || is_writing_ || is_closing_) return;
    if (!queue_.empty()) {
      message_ = std::move(queue_.front());
      queue_.pop_front();
      return write(LiveWorld::clock());
    }
    if (!is_ending_) return;
    is_closing_ = true;
    socket_.async_close(websocket::close_code::normal,
                        [self = this->shared_from_this()](error_code) {});
  }

  void write(double now) {
    is_writing_ = true;
    write_began_ = now;
    socket_.async_write(asio::buffer(message_),
                        [self = this->shared_from_this()](error_code fault, std::size_t) {
                          self->is_writing_ = false;
                          self->last_write_ = LiveWorld::clock() - self->write_began_;
                          if (!fault) self->write_next();
                        });
  }

  /// Closes without a handshake: a page that does not read would not receive it.
  void drop() { beast::get_lowest_layer(socket_).close(); }

  Hub& hub_;
  Peer peer_;
  websocket::stream<Stream> socket_;
  LiveSessions::PageId page_;
  std::optional<NetworkCount> place_;  ///< of an admitted page
  double opened_ = 0.0;                ///< [s] when the handshake was done
  beast::flat_buffer buffer_{kMaxLiveMessageBytes};
  std::deque<std::vector<std::uint8_t>> queue_;
  std::vector<std::uint8_t> message_;  ///< the one that is being written
  double write_began_ = 0.0;           ///< [s]
  double last_write_ = 0.0;            ///< [s] duration of the last write
  int received_since_tick_ = 0;
  int pings_since_tick_ = 0;
  std::shared_ptr<LiveSession> paused_self_;  ///< keeps itself alive until the next tick
  bool is_open_ = false;
  bool is_writing_ = false;
  bool is_ending_ = false;
  bool is_closing_ = false;
};

}  // namespace pcavr::network
