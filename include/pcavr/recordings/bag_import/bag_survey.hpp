// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"

namespace pcavr {

/// The content of a bag in one topic.
struct SurveyedTopic {
  BagTopic topic;
  RosMessageKind kind = RosMessageKind::other;
  std::size_t messages = 0;
  Stamp first, last;  ///< log time; of no meaning without messages
  /// Rate of the log times [Hz]; nullopt for less than two messages.
  std::optional<double> rate = {};
  double longest_interval = 0.0;  ///< [s] between log times of two messages that follow each other
  std::size_t undecodable = 0;    ///< messages of a known type that can't be decoded
  std::string problem = {};       ///< of the first of them
  std::size_t unstamped = 0;      ///< decoded messages whose header stamp is zero or absent
  /// [s] from header stamp to log time, median; nullopt where no message has a stamp.
  std::optional<double> delay = {};
  std::vector<std::string> frames = {};  ///< of the headers, without leading slash, at most 8
  // Fields of images, from the first message.
  std::string image_format = {};  ///< encoding or format
  int width = 0;                  ///< [px]; 0 where a compressed image does not show it
  int height = 0;
  // Joint states: number of messages for each list of joint names; at most 16 lists.
  std::map<std::vector<std::string>, std::size_t> joints = {};

  /// Whether the payload's encoding is one that MCAP or rosbag2 defines.
  [[nodiscard]] bool has_known_encoding() const;
};

struct BagSurvey {
  std::vector<SurveyedTopic> topics;  ///< by name
  std::vector<std::string> warnings;
  CsvOptions csv = {};  ///< by which CSV files were read
  std::size_t messages = 0;
  Stamp first, last;  ///< log time; of no meaning without messages
  /// Parent and child of the transforms of all TF topics, and how often each occurs.
  std::map<std::pair<std::string, std::string>, std::size_t> transforms;

  [[nodiscard]] const SurveyedTopic* find(const std::string& name) const;
  [[nodiscard]] bool has_frame(const std::string& frame) const;
};

/// Reads a bag once, with flat memory. An Error where no topic has a known serialization.
[[nodiscard]] Expected<BagSurvey> survey_bag(const std::filesystem::path& bag,
                                             const Observer& observer = {},
                                             const CsvOptions& csv = {});

/// Whether transforms of this topic are TF, and not a tracked object's.
[[nodiscard]] bool is_tf_topic(const SurveyedTopic& topic);
/// Whether the images are depth, by encoding, format or name.
[[nodiscard]] bool is_depth_topic(const SurveyedTopic& topic);
[[nodiscard]] bool is_color_topic(const SurveyedTopic& topic);

}  // namespace pcavr
