// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "pcavr/rosbag/bag_reader.hpp"

namespace pcavr {

/// Merges the connections of a bag by topic, type and encoding.
class TopicTable {
 public:
  /// The index of the topic, which is added if it is new.
  std::size_t add(const BagTopic& topic) {
    const auto [entry, is_new] =
        index_.try_emplace({topic.name, topic.type, topic.encoding}, topics_.size());
    if (is_new) topics_.push_back(topic);
    return entry->second;
  }
  [[nodiscard]] const std::vector<BagTopic>& topics() const { return topics_; }

 private:
  std::vector<BagTopic> topics_;
  std::map<std::tuple<std::string, std::string, std::string>, std::size_t> index_;
};

}  // namespace pcavr
