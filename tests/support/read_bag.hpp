// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

namespace pcavr::test {

struct ReadMessage {
  std::string topic;
  std::int64_t log_time = 0, publish_time = 0;
  std::string payload;
  auto operator<=>(const ReadMessage&) const = default;
};

struct ReadBag {
  std::vector<ReadMessage> messages;
  std::vector<std::string> warnings;
  std::vector<BagTopic> topics;
  std::string error;
};

/// All messages of a bag, or those before its error.
inline ReadBag read_all(Expected<std::unique_ptr<BagReader>> reader) {
  ReadBag read;
  if (!reader) {
    read.error = reader.error().to_string();
    return read;
  }
  for (;;) {
    const Expected<std::optional<BagMessage>> message = (*reader)->next();
    if (!message) read.error = message.error().to_string();
    if (!message || !*message) break;
    const BagMessage& m = **message;
    read.messages.push_back({(*reader)->topics()[m.topic].name, m.log_time.nanoseconds,
                             m.publish_time.nanoseconds,
                             std::string(m.payload.begin(), m.payload.end())});
  }
  read.warnings = (*reader)->warnings();
  read.topics = (*reader)->topics();
  return read;
}

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace pcavr::test
