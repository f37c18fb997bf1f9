// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "foxglove_client.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/json_text.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kProtocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr std::uint8_t kMessageData = 1;  // opcode
constexpr int kWarning = 1;               // level of a status

std::string status(const std::string& text) {
  return json_text(Json{{"op", "status"}, {"level", kWarning}, {"message", text}});
}

/// An id of the protocol: 32 bits.
std::optional<std::uint32_t> id_in(const Json& json, const char* key) {
  if (!json.is_object() || !json.contains(key)) return std::nullopt;
  const Json& value = json.at(key);
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto id = value.get<std::uint64_t>();
  if (id > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(id);
}

const Json& list_in(const Json& json, const char* key) {
  static const Json kNone = Json::array();
  const auto found = json.find(key);
  return found != json.end() && found->is_array() ? *found : kNone;
}

}  // namespace

std::string foxglove_protocol_in(std::string_view subprotocols) {
  while (!subprotocols.empty()) {
    const std::size_t comma = std::min(subprotocols.find(','), subprotocols.size());
    std::string_view name = subprotocols.substr(0, comma);
    subprotocols.remove_prefix(std::min(comma + 1, subprotocols.size()));
    while (name.starts_with(' ')) name.remove_prefix(1);
    while (name.ends_with(' ')) name.remove_suffix(1);
    if (std::find(kProtocols.begin(), kProtocols.end(), name) != kProtocols.end()) {
      return std::string(name);
    }
  }
  return {};
}

std::vector<std::string> FoxgloveClient::greeting(std::string_view version) const {
  const Json info{{"op", "serverInfo"},
                  {"name", "pcavr"},
                  {"capabilities", Json::array()},
                  {"supportedEncodings", Json::array()},
                  {"metadata", {{"version", version}}}};
  Json advertise{{"op", "advertise"}, {"channels", Json::array()}};
  for (const ViewerChannels::Channel& channel : channels_.channels()) {
    advertise["channels"].push_back({{"id", channel.id},
                                     {"topic", channel.topic},
                                     {"encoding", "cdr"},
                                     {"schemaName", channel.schema_name},
                                     {"schema", channel.schema},
                                     {"schemaEncoding", "ros2msg"}});
  }
  return {json_text(info), json_text(advertise)};
}

FoxgloveClient::Result FoxgloveClient::on_text(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return {.reply = status("not a message of this protocol: no JSON object")};
  const auto op = json.find("op");
  if (op == json.end() || !op->is_string()) return {.reply = status("a message without its op")};
  Result result;
  if (*op == "subscribe") {
    for (const Json& entry : list_in(json, "subscriptions")) {
      const auto id = id_in(entry, "id");
      const auto channel = id_in(entry, "channelId");
      if (!id || !channel || channels_.find(*channel) == nullptr) {
        result.reply = status("a subscription to a channel that does not exist");
      } else if (!subscriptions_.emplace(*channel, *id).second) {
        result.reply = status("already subscribed to " + channels_.find(*channel)->topic);
      } else {
        result.added.push_back(*channel);
      }
    }
  } else if (*op == "unsubscribe") {
    for (const Json& entry : list_in(json, "subscriptionIds")) {
      std::erase_if(subscriptions_,
                    [&](const auto& subscription) { return entry == subscription.second; });
    }
  } else {
    result.reply = status("this server is read-only: it has no such operation");
  }
  return result;
}

FoxgloveClient::Result FoxgloveClient::on_binary() {
  return {.reply = status("this server is read-only: nothing can be published")};
}

std::vector<std::uint8_t> foxglove_message_head(std::uint32_t subscription, Stamp stamp) {
  std::vector<std::uint8_t> head;
  ByteWriter writer(head);
  writer.integer(kMessageData);
  writer.integer(subscription);
  writer.integer(static_cast<std::uint64_t>(stamp.nanoseconds));
  return head;
}

}  // namespace pcavr
