// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/stamp.hpp"

#include "recordings/rosbag/record_fields.hpp"

namespace pcavr::mcap {

// The content of MCAP records, as views of the record's bytes; nullopt where it is not valid.

struct SchemaContent {
  std::uint16_t id = 0;
  std::string_view name, encoding, data;
};

struct ChannelContent {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;  ///< 0: none
  std::string_view topic, message_encoding;
  std::span<const std::uint8_t> metadata;  ///< a map of texts
};

struct MessageContent {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;  ///< [ns]
  std::span<const std::uint8_t> data;
};

[[nodiscard]] inline Stamp stamp_of(std::uint64_t nanoseconds) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return {static_cast<std::int64_t>(std::min(nanoseconds, kMax))};
}

using TextMap = std::vector<std::pair<std::string, std::string>>;

[[nodiscard]] inline std::optional<SchemaContent> parse_schema(
    std::span<const std::uint8_t> content) {
  RecordFields fields(content);
  SchemaContent schema;
  schema.id = fields.integer<std::uint16_t>();
  schema.name = fields.text();
  schema.encoding = fields.text();
  schema.data = fields.text();
  return fields.is_valid() && schema.id != 0 ? std::optional(schema) : std::nullopt;
}

[[nodiscard]] inline std::optional<ChannelContent> parse_channel(
    std::span<const std::uint8_t> content) {
  RecordFields fields(content);
  ChannelContent channel;
  channel.id = fields.integer<std::uint16_t>();
  channel.schema = fields.integer<std::uint16_t>();
  channel.topic = fields.text();
  channel.message_encoding = fields.text();
  if (!fields.is_valid()) return std::nullopt;
  channel.metadata = fields.sized();  // readers do without it
  return channel;
}

[[nodiscard]] inline std::optional<MessageContent> parse_message(
    std::span<const std::uint8_t> content) {
  RecordFields fields(content);
  MessageContent message;
  message.channel = fields.integer<std::uint16_t>();
  message.sequence = fields.integer<std::uint32_t>();
  message.log_time = fields.integer<std::uint64_t>();
  message.publish_time = fields.integer<std::uint64_t>();
  message.data = fields.rest();
  return fields.is_valid() ? std::optional(message) : std::nullopt;
}

[[nodiscard]] inline std::optional<TextMap> parse_text_map(std::span<const std::uint8_t> bytes) {
  RecordFields fields(bytes);
  TextMap entries;
  while (!fields.is_at_end()) {
    std::string key(fields.text());
    entries.emplace_back(std::move(key), fields.text());
    if (!fields.is_valid()) return std::nullopt;
  }
  return entries;
}

}  // namespace pcavr::mcap
