// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "network.hpp"

namespace pcavr::network {

/// Words wait here while one is on its way; a page that lets more than this pile up does not read.
inline constexpr std::size_t kMaxWords = 16;
/// Between two states; a page has some 70 to 90 samples a second to say, and no reason for more.
inline constexpr int kMaxMessagesPerTick = 20;
/// [bytes] What the system may keep back for us: some 50 ms of states. With more, a slow page would
/// see what was long ago.
inline constexpr int kSendBuffer = 8192;

/// One page's WebSocket. At most one message is being written; a state is made only when it can go.
template <typename Stream>
class LiveSession final : public LivePage,
                          public std::enable_shared_from_this<LiveSession<Stream>> {
 public:
  LiveSession(Hub& hub, Stream&& stream, Peer peer)
      : hub_(hub), peer_(std::move(peer)), socket_(std::move(stream)), page_(hub.room.join()) {
    hub_.pages.emplace(page_, this);
  }
  ~LiveSession() override {
    hub_.pages.erase(page_);
    hub_.room.leave(page_);
  }

  template <typename Request>
  void open(const Request& request) {
    beast::get_lowest_layer(socket_).expires_never();
    error_code ignored;
    tcp::socket& transport = beast::get_lowest_layer(socket_).socket();
    transport.set_option(tcp::no_delay(true), ignored);
    transport.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::seconds(10);
    limits.idle_timeout = std::chrono::seconds(20);
    limits.keep_alive_pings = true;
    socket_.set_option(limits);
    socket_.read_message_max(kLiveMostBytes);
    socket_.auto_fragment(false);
    socket_.binary(true);
    socket_.async_accept(request, [self = this->shared_from_this()](error_code fault) {
      if (!fault) self->begin();
    });
  }

  void send(std::vector<std::uint8_t> message) override {
    if (words_.size() >= kMaxWords) return drop();
    words_.push_back(std::move(message));
    write_next();
  }

  void tick(double now) override {
    heard_since_tick_ = 0;
    if (const auto self = std::exchange(waits_to_read_, nullptr)) read();
    if (is_writing_) {
      if (now - write_began_ > hub_.options.max_write_time) drop();
      return;
    }
    if (!is_open_ || is_ending_ || !hub_.room.is_greeted(page_)) return;
    hub_.room.write_state(page_, now, last_write_, message_);
    write(now);
  }

  void end() override {
    is_ending_ = true;
    write_next();
    waits_to_read_.reset();
  }

 private:
  void begin() {
    is_open_ = true;
    if (hub_.pages.size() > hub_.options.max_pages) {
      const std::string most = std::to_string(hub_.options.max_pages);
      words_.push_back(
          encode(ServerMessage{{1, LiveWorld::clock()},
                               LiveNotice{LiveLevel::error, most + " pages are open: no more"}}));
      return end();
    }
    read();
  }

  void read() {
    if (heard_since_tick_ >= kMaxMessagesPerTick) {
      // Until then nothing else may hold the session.
      waits_to_read_ = this->shared_from_this();
      return;
    }
    socket_.async_read(buffer_, [self = this->shared_from_this()](error_code fault, std::size_t) {
      if (!fault) self->hear();
    });
  }

  void hear() {
    ++heard_since_tick_;
    const auto bytes = buffer_.cdata();
    const bool goes_on =
        !is_ending_ &&
        hub_.room.hear(page_, {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                       LiveWorld::clock());
    buffer_.consume(buffer_.size());
    if (!goes_on) return end();
    read();
  }

  void write_next() {
    if (!is_open_ || is_writing_ || is_closing_) return;
    if (!words_.empty()) {
      message_ = std::move(words_.front());
      words_.pop_front();
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

  /// At once: whoever does not read can't be told either.
  void drop() { beast::get_lowest_layer(socket_).close(); }

  Hub& hub_;
  Peer peer_;
  websocket::stream<Stream> socket_;
  LiveRoom::PageId page_;
  beast::flat_buffer buffer_{kLiveMostBytes};
  std::deque<std::vector<std::uint8_t>> words_;
  std::vector<std::uint8_t> message_;  ///< the one that is being written
  double write_began_ = 0.0;           ///< [s]
  double last_write_ = 0.0;            ///< [s] that the last message took to go
  int heard_since_tick_ = 0;
  std::shared_ptr<LiveSession> waits_to_read_;  ///< itself, until the next tick
  bool is_open_ = false;
  bool is_writing_ = false;
  bool is_ending_ = false;
  bool is_closing_ = false;
};

}  // namespace pcavr::network
