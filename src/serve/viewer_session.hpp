// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foxglove_client.hpp"
#include "streams.hpp"

namespace pcavr::network {

inline constexpr double kViewerInterval = 1.0 / 30.0;  // [s] between a viewer's states
inline constexpr double kSlowInterval = 1.0;           // [s] of channels with the slow rate

/// Another viewer's WebSocket. Backpressure: states are encoded only when all that was sent before
/// has gone, so a slow viewer gets fewer states, and one that does not read is disconnected.
template <typename Stream>
class ViewerSession final : public Client,
                            public std::enable_shared_from_this<ViewerSession<Stream>> {
 public:
  ViewerSession(Hub& hub, Stream&& stream, Peer peer)
      : hub_(hub), peer_(std::move(peer)), socket_(std::move(stream)), client_(hub.channels) {
    hub_.viewers.insert(this);
  }
  ~ViewerSession() override { hub_.viewers.erase(this); }

  template <typename Request>
  void open(const Request& request, const std::string& protocol) {
    set_up(socket_, hub_.options);
    socket_.set_option(websocket::stream_base::decorator([protocol](auto& response) {
      response.set(http::field::sec_websocket_protocol, protocol);
    }));
    socket_.async_accept(request, [self = this->shared_from_this()](error_code fault) {
      if (!fault) self->begin();
    });
  }

  void tick(double now) override {
    received_since_tick_ = 0;
    if (const auto self = std::exchange(paused_self_, nullptr)) read();
    if (is_writing_) {
      if (now - write_began_ > max_write_time_) drop();
      return;
    }
    if (!is_open_ || is_ending_ || now - last_state_ < kViewerInterval) return;
    last_state_ = now;
    const bool is_slow_due = now - last_slow_ >= kSlowInterval;
    if (is_slow_due) last_slow_ = now;
    for (const auto& [id, subscription] : client_.subscriptions()) {
      const ViewerChannels::Channel& channel = *hub_.channels.find(id);
      const bool is_due = channel.rate == ViewerChannels::Rate::changed ||
                          (channel.rate == ViewerChannels::Rate::slow && is_slow_due);
      if (is_due) push_state(channel, subscription);
    }
    write_next();
  }

  void end() override {
    is_ending_ = true;
    write_next();
    paused_self_.reset();
  }

 private:
  struct Outgoing {
    bool is_text = false;
    std::vector<std::uint8_t> head;
    ViewerPayload payload = {};  ///< after the head
  };

  void begin() {
    const ServerOptions& options = hub_.options;
    if (pages_of(hub_, peer_.network) >= share_of(options.max_pages, options) ||
        pages_of(hub_) >= options.max_pages) {
      return drop();
    }
    place_.emplace(hub_.pages_by_network, peer_.network);
    is_open_ = true;
    for (const std::string& text : client_.greeting(options.version)) push_text(text);
    write_next();
    read();
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
    const FoxgloveClient::Result result =
        socket_.got_text() ? client_.on_text({static_cast<const char*>(bytes.data()), bytes.size()})
                           : client_.on_binary();
    buffer_.consume(buffer_.size());
    if (is_ending_) return;
    if (std::ssize(queue_) >= hub_.options.max_queued_messages + channel_count()) return drop();
    if (result.reply) push_text(*result.reply);
    for (const std::uint32_t id : result.added) {
      const ViewerChannels::Channel& channel = *hub_.channels.find(id);
      if (channel.rate == ViewerChannels::Rate::once) {
        push_state(channel, client_.subscriptions().at(id));
      }
    }
    write_next();
    read();
  }

  [[nodiscard]] std::ptrdiff_t channel_count() const {
    return std::ssize(hub_.channels.channels());
  }

  void push_text(const std::string& text) {
    queue_.push_back({.is_text = true, .head = {text.begin(), text.end()}});
  }

  void push_state(const ViewerChannels::Channel& channel, std::uint32_t subscription) {
    ViewerPayload payload = hub_.channels.payload(channel);
    if (!payload) return;
    queue_.push_back({.head = foxglove_message_head(subscription, hub_.channels.stamp()),
                      .payload = std::move(payload)});
  }

  void write_next() {
    if (!is_open_ || is_writing_ || is_closing_) return;
    if (queue_.empty()) {
      if (is_ending_) close();
      return;
    }
    message_ = std::move(queue_.front());
    queue_.pop_front();
    is_writing_ = true;
    write_began_ = LiveWorld::clock();
    const std::size_t size = message_.payload ? message_.payload->size() : 0;
    max_write_time_ =
        hub_.options.max_write_time + static_cast<double>(size) / hub_.options.min_download_rate;
    socket_.text(message_.is_text);
    const std::array<asio::const_buffer, 2> parts{
        asio::buffer(message_.head),
        size == 0 ? asio::const_buffer() : asio::buffer(*message_.payload)};
    socket_.async_write(parts, [self = this->shared_from_this()](error_code fault, std::size_t) {
      self->is_writing_ = false;
      if (!fault) self->write_next();
    });
  }

  void close() {
    is_closing_ = true;
    socket_.async_close(websocket::close_code::normal,
                        [self = this->shared_from_this()](error_code) {});
  }

  /// Closes without a handshake: a viewer that does not read would not receive it.
  void drop() { beast::get_lowest_layer(socket_).close(); }

  Hub& hub_;
  Peer peer_;
  websocket::stream<Stream> socket_;
  FoxgloveClient client_;
  std::optional<NetworkCount> place_;  ///< of an admitted viewer
  beast::flat_buffer buffer_{kMaxLiveMessageBytes};
  std::deque<Outgoing> queue_;
  Outgoing message_;             ///< the one that is being written
  double write_began_ = 0.0;     ///< [s]
  double max_write_time_ = 0.0;  ///< [s] of `message_`
  double last_state_ = 0.0;      ///< [s]
  double last_slow_ = 0.0;       ///< [s]
  int received_since_tick_ = 0;
  std::shared_ptr<ViewerSession> paused_self_;  ///< keeps itself alive until the next tick
  bool is_open_ = false;
  bool is_writing_ = false;
  bool is_ending_ = false;
  bool is_closing_ = false;
};

}  // namespace pcavr::network
