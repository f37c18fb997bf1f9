// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "viewer_channels.hpp"

namespace pcavr {

/// The first of the client's WebSocket subprotocols [RFC 6455, 1.9] by which it asks for the
/// Foxglove protocol, version 1, under its present or its former name. Empty: none.
[[nodiscard]] std::string foxglove_protocol_in(std::string_view subprotocols);

/// One client of the Foxglove WebSocket protocol, version 1 [github.com/foxglove/ws-protocol]:
/// which channels it has subscribed to. Read-only: a client can neither publish nor set anything.
/// Without sockets.
class FoxgloveClient {
 public:
  /// Keeps the reference.
  explicit FoxgloveClient(const ViewerChannels& channels) : channels_(channels) {}

  /// The messages that a server sends first: serverInfo, and all channels.
  [[nodiscard]] std::vector<std::string> greeting(std::string_view version) const;

  struct Result {
    std::optional<std::string> reply = {};  ///< a status message
    std::vector<std::uint32_t> added = {};  ///< channels it has newly subscribed to
  };
  [[nodiscard]] Result on_text(std::string_view text);
  [[nodiscard]] Result on_binary();

  /// Subscription ids by channel id.
  [[nodiscard]] const std::map<std::uint32_t, std::uint32_t>& subscriptions() const {
    return subscriptions_;
  }

 private:
  const ViewerChannels& channels_;
  std::map<std::uint32_t, std::uint32_t> subscriptions_;
};

/// The bytes before a message's payload: opcode, subscription, time.
[[nodiscard]] std::vector<std::uint8_t> foxglove_message_head(std::uint32_t subscription,
                                                              Stamp stamp);

}  // namespace pcavr
