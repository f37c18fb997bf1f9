// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/bag_streams.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"

#include "recordings/bag_import/decoded_header.hpp"

namespace pcavr {
namespace {

/// Delays between sensor and recorder are below it, clocks of other epochs far above [s].
constexpr double kOtherClock = 10.0;

std::vector<const SurveyedTopic*> selected_topics(const BagSurvey& survey,
                                                  const BagSelection& selection) {
  std::vector<const SurveyedTopic*> topics;
  for (const SurveyedTopic& topic : survey.topics) {
    if (!selection.use_of(topic).empty()) topics.push_back(&topic);
  }
  return topics;
}

bool is_in_range(const Eigen::Vector3d& p, const InputRange& range) {
  return range.contains(p.x()) && range.contains(p.y()) && range.contains(p.z());
}

/// Sorts the messages of the selected topics into their series.
class StreamCollector {
 public:
  StreamCollector(const BagSelection& selection, const BagSurvey& survey, const StampRule& stamps)
      : selection_(selection), survey_(survey), stamps_(stamps) {
    streams_.wrench.topic = selection.wrench;
    streams_.joints.topic = selection.joints;
    streams_.depth.topic = selection.depth;
    streams_.color.topic = selection.color;
    for (const SurveyedTopic* topic : {selection.tool, selection.camera_pose}) {
      if (topic != nullptr) streams_.poses[topic].topic = topic;
    }
    for (const auto& [name, topic] : selection.objects) streams_.poses[topic].topic = topic;
  }

  /// nullptr where the topic is not needed.
  const SurveyedTopic* needed(const BagTopic& topic) const {
    for (const SurveyedTopic& known : survey_.topics) {
      const bool is_same = known.topic.name == topic.name && known.topic.type == topic.type &&
                           known.topic.encoding == topic.encoding;
      if (is_same) return selection_.use_of(known).empty() ? nullptr : &known;
    }
    return nullptr;
  }

  void add(const SurveyedTopic& topic, const BagMessage& message) {
    const Expected<RosMessage> decoded = decode_ros_message(topic.topic, message.payload);
    if (!decoded) return leave_out(topic, decoded.error().message);
    const std::vector<const RosHeader*> headers = headers_of(*decoded);
    const Stamp stamp =
        headers.empty() ? message.log_time : stamps_.stamp_of(topic, *headers[0], message.log_time);
    if (!ranges::kStamp.contains(stamp.seconds()))
      return leave_out(topic, "has a stamp out of range");
    if (&topic == selection_.depth) streams_.depth.rows.push_back({stamp, {}});
    if (&topic == selection_.color) streams_.color.rows.push_back({stamp, {}});
    if (const auto* info = std::get_if<RosCameraInfo>(&*decoded)) {
      auto& kept = &topic == selection_.depth_info ? streams_.depth_info : streams_.camera_info;
      if (!kept) kept = *info;
    }
    if (const auto* pose = std::get_if<RosPose>(&*decoded)) add_pose(topic, stamp, *pose);
    if (const auto* wrench = std::get_if<RosWrench>(&*decoded)) add_wrench(topic, stamp, *wrench);
    if (const auto* state = std::get_if<RosJointState>(&*decoded)) {
      streams_.joints.rows.push_back({stamp, *state});
    }
    if (const auto* found = std::get_if<RosTransforms>(&*decoded)) {
      add_transforms(topic, *found, message.log_time);
    }
  }

  BagStreams finish() {
    streams_.frames.finish();
    return std::move(streams_);
  }

 private:
  void add_pose(const SurveyedTopic& topic, Stamp stamp, const RosPose& pose) {
    if (!is_in_range(pose.position, ranges::kCoordinate)) {
      return leave_out(topic, "has a coordinate out of range");
    }
    const Eigen::Quaterniond q = pose.orientation.value_or(Eigen::Quaterniond::Identity());
    streams_.poses[&topic].rows.push_back(
        {stamp, {Pose(q, pose.position), pose.header.frame, pose.orientation.has_value()}});
  }

  void add_wrench(const SurveyedTopic& topic, Stamp stamp, const RosWrench& wrench) {
    if (!is_in_range(wrench.force, ranges::kForce) ||
        !is_in_range(wrench.torque, ranges::kTorque)) {
      return leave_out(topic, "has a force or torque out of range");
    }
    streams_.wrench.rows.push_back({stamp, {wrench.force, wrench.torque, wrench.header.frame}});
  }

  /// Adds transforms of TF, or the pose of a tracked object.
  void add_transforms(const SurveyedTopic& topic, const RosTransforms& found, Stamp log_time) {
    if (found.left_out > 0) leave_out(topic, "has a transform that is not finite or no rotation");
    for (const RosTransform& transform : found.transforms) {
      const Stamp stamp = stamps_.stamp_of(topic, transform.header, log_time);
      if (!is_in_range(transform.translation, ranges::kCoordinate)) {
        leave_out(topic, "has a coordinate out of range");
        continue;
      }
      const Pose pose(transform.rotation, transform.translation);
      if (is_static_tf(topic.topic.name)) {
        streams_.frames.add_static(transform.header.frame, transform.child_frame,
                                   stamps_.arrival_of(log_time), pose);
      } else if (is_tf_topic(topic)) {
        streams_.frames.add(transform.header.frame, transform.child_frame, stamp, pose);
      } else {
        streams_.poses[&topic].rows.push_back({stamp, {pose, transform.header.frame, true}});
      }
    }
  }

  void leave_out(const SurveyedTopic& topic, const std::string& reason) {
    const auto count = [&](auto& collected) {
      if (collected.left_out++ == 0) collected.left_out_reason = reason;
    };
    if (&topic == selection_.depth) return count(streams_.depth);
    if (&topic == selection_.color) return count(streams_.color);
    if (&topic == selection_.wrench) return count(streams_.wrench);
    if (&topic == selection_.joints) return count(streams_.joints);
    if (const auto found = streams_.poses.find(&topic); found != streams_.poses.end()) {
      count(found->second);
    }
  }

  const BagSelection& selection_;
  const BagSurvey& survey_;
  const StampRule& stamps_;
  BagStreams streams_;
};

}  // namespace

StampRule::StampRule(const BagSurvey& survey, const BagSelection& selection,
                     bool use_receive_stamps)
    : use_receive_stamps_(use_receive_stamps) {
  std::vector<double> delays;
  const std::vector<const SurveyedTopic*> topics = selected_topics(survey, selection);
  for (const SurveyedTopic* topic : topics) {
    // The stamps of static transforms say when these were set, perhaps long before.
    const bool is_series = topic->delay && !is_static_tf(topic->topic.name);
    if (is_series) delays.push_back(*topic->delay);
  }
  if (delays.empty()) return;
  std::sort(delays.begin(), delays.end());
  // Whether all are on one clock, be it the recorder's or not (a simulation's, a bag recorded
  // again).
  const bool is_one_clock = delays.back() - delays.front() < kOtherClock;
  if (is_one_clock && !use_receive_stamps) {
    shift_ = -duration_from_seconds(delays[delays.size() / 2]);
  }
  for (const SurveyedTopic* topic : topics) {
    if (is_one_clock || !topic->delay || is_static_tf(topic->topic.name)) continue;
    const bool is_recorders = std::abs(*topic->delay) < kOtherClock;
    if (!is_recorders) outliers_.push_back(topic);
  }
}

bool StampRule::uses_log_time(const SurveyedTopic& topic) const {
  return use_receive_stamps_ ||
         std::find(outliers_.begin(), outliers_.end(), &topic) != outliers_.end();
}

Stamp StampRule::stamp_of(const SurveyedTopic& topic, const RosHeader& header,
                          Stamp log_time) const {
  return uses_log_time(topic) ? log_time : header.stamp.value_or(log_time);
}

Expected<BagStreams> collect_streams(const std::filesystem::path& bag,
                                     const BagSelection& selection, const BagSurvey& survey,
                                     const StampRule& stamps, const Observer& observer) {
  Expected<std::unique_ptr<BagReader>> reader = open_bag_or_csv(bag, survey.csv);
  if (!reader) return reader.error();
  StreamCollector collector(selection, survey, stamps);
  std::vector<const SurveyedTopic*> topics;
  for (std::size_t done = 1;; ++done) {
    const Expected<std::optional<BagMessage>> message = (*reader)->next();
    if (!message) return message.error();
    if (!*message) return collector.finish();
    while (topics.size() < (*reader)->topics().size()) {
      topics.push_back(collector.needed((*reader)->topics()[topics.size()]));
    }
    const SurveyedTopic* topic = topics[(*message)->topic];
    if (topic != nullptr) collector.add(*topic, **message);
    observer.on_progress("collecting", done, survey.messages);
  }
}

}  // namespace pcavr
