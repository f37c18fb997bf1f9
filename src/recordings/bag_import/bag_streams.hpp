// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/recordings/bag_import/bag_selection.hpp"
#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/rosbag/transform_tree.hpp"

namespace pcavr {

/// A row of a time series before its stamps are sorted.
template <typename Value>
struct StampedValue {
  Stamp stamp;
  Value value;
};

struct FramedPose {
  Pose T_frame_body;
  std::string frame;
  bool has_orientation = true;
};

struct FramedWrench {
  Eigen::Vector3d force, torque;
  std::string frame;
};

/// The messages of one topic, in the order of the bag.
template <typename Value>
struct CollectedTopic {
  const SurveyedTopic* topic = nullptr;
  std::vector<StampedValue<Value>> rows;
  std::size_t left_out = 0;
  std::string left_out_reason;
};

/// All time series that an import takes, as read.
struct BagStreams {
  std::map<const SurveyedTopic*, CollectedTopic<FramedPose>> poses;
  CollectedTopic<FramedWrench> wrench;
  CollectedTopic<RosJointState> joints;
  CollectedTopic<std::monostate> depth, color;           ///< stamps only
  std::optional<RosCameraInfo> camera_info, depth_info;  ///< the first of each
  TransformTree frames;
};

/// Chooses for each topic whether header stamps or log times are used.
class StampRule {
 public:
  /// Header stamps; where the selected topics are on clocks more than 10 s apart, only for those
  /// within 10 s of the recorder's.
  StampRule(const BagSurvey& survey, const BagSelection& selection, bool use_receive_stamps);

  [[nodiscard]] bool uses_log_time(const SurveyedTopic& topic) const;
  [[nodiscard]] Stamp stamp_of(const SurveyedTopic& topic, const RosHeader& header,
                               Stamp log_time) const;
  /// The time at which a message arrived, on the clock of the stamps in use.
  [[nodiscard]] Stamp arrival_of(Stamp log_time) const { return log_time + shift_; }
  /// The topics whose header stamps are on another clock.
  [[nodiscard]] const std::vector<const SurveyedTopic*>& outliers() const { return outliers_; }

 private:
  bool use_receive_stamps_;
  Duration shift_{0};  ///< from the recorder's clock to that of the headers
  std::vector<const SurveyedTopic*> outliers_;
};

/// Reads the bag once for everything but the images' pixels.
[[nodiscard]] Expected<BagStreams> collect_streams(const std::filesystem::path& bag,
                                                   const BagSelection& selection,
                                                   const BagSurvey& survey, const StampRule& stamps,
                                                   const Observer& observer);

}  // namespace pcavr
