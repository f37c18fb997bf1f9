// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/bag_import/bag_survey.hpp"

namespace pcavr {

/// The topics to import. A topic without a name is chosen where it is unambiguous. Names of topics
/// and frames are the same with and without a leading slash.
struct BagTopicOptions {
  std::string depth_topic = {};
  std::string color_topic = {};  ///< "none": depth alone, which need not be registered
  std::string camera_info_topic = {};
  std::string camera_pose_topic = {};  ///< pose of the camera's optical frame; else by TF
  std::string tool_topic = {};         ///< poses or points of the tool's tip
  std::string tool_frame = {};         ///< instead of a topic: the tip's frame in TF
  std::string base_frame = {};
  std::string wrench_topic = {};
  std::string wrench_frame = {};  ///< instead of the frame in the messages' headers
  std::string joint_topic = {};
  /// Name and topic of each tracked object; without any, one for each TransformStamped topic, and
  /// for each topic of poses that has one of `object_names`.
  std::vector<std::pair<std::string, std::string>> objects = {};
  std::set<std::string> object_names = {};  ///< that the manifest declares
};

/// The topics that an import takes; nullptr and empty: none. Points into the survey.
struct BagSelection {
  const SurveyedTopic* depth = nullptr;
  /// Also without depth, where the bag has none: tags are found in colour alone.
  const SurveyedTopic* color = nullptr;
  const SurveyedTopic* camera_info = nullptr;
  /// Camera info of the depth images alone, found by its name. Depth is registered to colour where
  /// it equals camera_info.
  const SurveyedTopic* depth_info = nullptr;
  const SurveyedTopic* camera_pose = nullptr;
  const SurveyedTopic* tool = nullptr;
  const SurveyedTopic* wrench = nullptr;
  const SurveyedTopic* joints = nullptr;
  std::vector<std::pair<std::string, const SurveyedTopic*>> objects;
  std::string base_frame;  ///< empty: poses are taken as they are
  bool is_base_frame_given = false;
  std::vector<std::string> notes;  ///< what was not taken, and by which option it can be
  /// Images that may be the missing depth or colour, but have an encoding that is not read: one
  /// text each, "TOPIC is ENCODING, which is not read". Also in the notes.
  std::vector<std::string> unread_images;

  /// The topic after which frames are named and placed: depth, else colour; nullptr without images.
  [[nodiscard]] const SurveyedTopic* images() const { return depth != nullptr ? depth : color; }
  [[nodiscard]] bool is_empty(const BagTopicOptions& options) const;
  /// The use of the topic ("tool.csv", "objects/box"); empty where it is not taken.
  [[nodiscard]] std::string use_of(const SurveyedTopic& topic) const;
};

/// Chooses topics. An Error, with near matches, for a topic or frame that is not in the bag, and
/// for a topic of a type that can't be taken for the option.
[[nodiscard]] Expected<BagSelection> select_bag_topics(const std::filesystem::path& bag,
                                                       const BagSurvey& survey,
                                                       const BagTopicOptions& options);

}  // namespace pcavr
