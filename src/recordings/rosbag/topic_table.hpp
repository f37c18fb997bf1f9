// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/record_fields.hpp"

namespace pcavr {

/// Largest size of the names and definitions of all topics of a bag [bytes]: a thousand types of 50
/// kB. A small file may repeat one definition for any number of topics.
inline constexpr std::size_t kMaxTopicBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxTopicName = std::size_t{64} << 10;  ///< [bytes]

/// Merges the connections of a bag by topic, type and encoding.
class TopicTable {
 public:
  /// The index of the topic, which is added if it is new. An Error, without file, beyond
  /// kMaxTopicBytes.
  Expected<std::size_t> add(BagTopic topic) {
    if (topic.name.size() > kMaxTopicName || topic.type.size() > kMaxTopicName) {
      return Error{.message = "a topic whose name or type has more than 64 KiB"};
    }
    topic.name = printable_name(topic.name);
    topic.type = printable_name(topic.type);
    topic.encoding = printable_name(topic.encoding);
    const auto [entry, is_new] =
        index_.try_emplace({topic.name, topic.type, topic.encoding}, topics_.size());
    if (!is_new) return entry->second;
    bytes_ += sizeof(BagTopic) + 2 * (topic.name.size() + topic.type.size()) + topic.schema.size();
    if (bytes_ > kMaxTopicBytes) {
      return Error{.message = "topics whose names and definitions have more than 64 MiB"};
    }
    topics_.push_back(std::move(topic));
    return entry->second;
  }
  [[nodiscard]] const std::vector<BagTopic>& topics() const { return topics_; }

 private:
  std::size_t bytes_ = 0;
  std::vector<BagTopic> topics_;
  std::map<std::tuple<std::string, std::string, std::string>, std::size_t> index_;
};

}  // namespace pcavr
