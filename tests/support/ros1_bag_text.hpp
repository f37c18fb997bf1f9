// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/stamp.hpp"

/// The bytes of a ROS 1 bag, made record by record.
class Ros1BagText {
 public:
  using Fields = std::vector<std::pair<std::string, std::string>>;

  static std::string number(std::uint64_t value, int size) {
    std::string text;
    for (int i = 0; i < size; ++i) text += static_cast<char>((value >> (8 * i)) & 0xFFU);
    return text;
  }
  static std::string sized(const std::string& text) { return number(text.size(), 4) + text; }
  static std::string fields(const Fields& entries) {
    std::string text;
    for (const auto& [key, value] : entries) text += sized(key + "=" + value);
    return text;
  }
  static std::string record(const Fields& header, const std::string& data) {
    return sized(fields(header)) + sized(data);
  }
  static std::string op(int code) { return std::string(1, static_cast<char>(code)); }

  /// Adds a message, and its connection where that is new.
  void add(const std::string& topic, const std::string& type, pcavr::Stamp stamp,
           const std::string& payload) {
    const auto [entry, is_new] = connections_.try_emplace(topic, connections_.size());
    const std::string id = number(entry->second, 4);
    if (is_new) {
      chunk += record({{"op", op(7)}, {"conn", id}, {"topic", topic}},
                      fields({{"topic", topic}, {"type", type}, {"message_definition", ""}}));
    }
    const auto t = static_cast<std::uint64_t>(stamp.nanoseconds);
    chunk += record({{"op", op(2)},
                     {"conn", id},
                     {"time", number(t / 1'000'000'000, 4) + number(t % 1'000'000'000, 4)}},
                    payload);
    ++messages;
  }
  static std::string chunk_record(const std::string& compression, std::uint64_t size,
                                  const std::string& data) {
    return record({{"op", op(5)}, {"compression", compression}, {"size", number(size, 4)}}, data);
  }
  /// The bag with one uncompressed chunk, `between` bytes, and an index that counts the messages.
  [[nodiscard]] std::string bag(const std::string& between = {}) const {
    const std::string body = chunk_record("none", chunk.size(), chunk) + between;
    const std::string start = "#ROSBAG V2.0\n";
    const std::size_t header_size = bag_header(0, "").size();
    return start + bag_header(start.size() + header_size + body.size(), "") + body +
           record({{"op", op(6)}, {"ver", number(1, 4)}, {"count", number(1, 4)}},
                  number(0, 4) + number(messages, 4));
  }
  static std::string bag_header(std::uint64_t index_at, const std::string& encryptor) {
    return record({{"op", op(3)}, {"index_pos", number(index_at, 8)}, {"encryptor", encryptor}},
                  std::string(100, ' '));
  }

  std::string chunk;
  std::size_t messages = 0;

 private:
  std::map<std::string, std::size_t> connections_;
};
