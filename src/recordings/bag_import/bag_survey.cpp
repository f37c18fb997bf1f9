// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/bag_survey.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"

#include "recordings/bag_import/decoded_header.hpp"
#include "recordings/bag_import/raw_color.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxFrameNames = 8;
constexpr std::size_t kMaxJointSets = 16;
constexpr std::size_t kMaxTransformPairs = 10'000;

/// A sample of a series of any length, of at most 4096 values: every n-th of them.
class ThinnedSample {
 public:
  void add(double value) {
    if (count_++ % step_ != 0) return;
    values_.push_back(value);
    if (values_.size() < kMaxValues) return;
    for (std::size_t i = 0; 2 * i < values_.size(); ++i) values_[i] = values_[2 * i];
    values_.resize(values_.size() / 2);
    step_ *= 2;
  }
  [[nodiscard]] std::optional<double> median() const {
    if (values_.empty()) return std::nullopt;
    std::vector<double> values = values_;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

 private:
  static constexpr std::size_t kMaxValues = 4096;
  std::vector<double> values_;
  std::size_t count_ = 0;
  std::size_t step_ = 1;
};

/// The survey of one topic while the bag is read.
class TopicSurveyor {
 public:
  explicit TopicSurveyor(const BagTopic& topic) {
    survey_.topic = topic;
    survey_.kind = ros_message_kind(topic.type);
  }

  void add(const BagMessage& message, BagSurvey& bag) {
    if (survey_.messages++ == 0) survey_.first = survey_.last = message.log_time;
    survey_.longest_interval =
        std::max(survey_.longest_interval, to_seconds(message.log_time - survey_.last));
    survey_.first = std::min(survey_.first, message.log_time);
    survey_.last = std::max(survey_.last, message.log_time);
    if (survey_.kind == RosMessageKind::other) return;
    const Expected<RosMessage> decoded = decode_ros_message(survey_.topic, message.payload);
    if (!decoded) {
      if (survey_.undecodable++ == 0) survey_.problem = decoded.error().message;
      return;
    }
    for (const RosHeader* header : headers_of(*decoded)) add_header(*header, message.log_time);
    add_content(*decoded, bag);
  }

  SurveyedTopic finish() {
    survey_.delay = delays_.median();
    const double span = to_seconds(survey_.last - survey_.first);
    if (survey_.messages > 1 && span > 0.0) {
      survey_.rate = static_cast<double>(survey_.messages - 1) / span;
    }
    return survey_;
  }

 private:
  void add_header(const RosHeader& header, Stamp log_time) {
    if (!header.stamp) ++survey_.unstamped;
    if (header.stamp) delays_.add(to_seconds(log_time - *header.stamp));
    std::vector<std::string>& frames = survey_.frames;
    const bool is_new = std::find(frames.begin(), frames.end(), header.frame) == frames.end();
    if (is_new && frames.size() < kMaxFrameNames) frames.push_back(header.frame);
  }

  void add_content(const RosMessage& message, BagSurvey& bag) {
    if (survey_.image_format.empty()) {
      const ImageSize size = image_size(message);
      survey_.width = size.width;
      survey_.height = size.height;
      if (const auto* image = std::get_if<RosImage>(&message))
        survey_.image_format = image->encoding;
      if (const auto* image = std::get_if<RosCompressedImage>(&message))
        survey_.image_format = image->format;
    }
    if (const auto* info = std::get_if<RosCameraInfo>(&message)) {
      survey_.width = info->width;
      survey_.height = info->height;
    }
    if (const auto* state = std::get_if<RosJointState>(&message)) {
      const auto known = survey_.joints.find(state->names);
      if (known != survey_.joints.end())
        ++known->second;
      else if (survey_.joints.size() < kMaxJointSets)
        survey_.joints[state->names] = 1;
    }
    const auto* found = std::get_if<RosTransforms>(&message);
    if (found == nullptr || !is_tf_topic(survey_)) return;
    for (const RosTransform& transform : found->transforms) {
      if (bag.transforms.size() < kMaxTransformPairs) {
        ++bag.transforms[{transform.header.frame, transform.child_frame}];
      }
    }
  }

  SurveyedTopic survey_;
  ThinnedSample delays_;
};

/// The serializations that the MCAP registry and rosbag2 list.
constexpr std::array<std::string_view, 7> kKnownEncodings{
    "ros1", "cdr", "json", "protobuf", "flatbuffer", "cbor", "msgpack"};

/// Refuses a bag of which no topic can be understood; names the others.
Expected<void> check_encodings(const std::filesystem::path& bag, BagSurvey& survey) {
  const SurveyedTopic* unknown = nullptr;
  bool has_known = false;
  for (const SurveyedTopic& topic : survey.topics) {
    if (topic.has_known_encoding())
      has_known = true;
    else
      unknown = &topic;
  }
  if (unknown == nullptr) return {};
  const std::string text = "topic '" + unknown->topic.name + "' is serialised as '" +
                           unknown->topic.encoding + "', which is not known";
  if (has_known) {
    survey.warnings.push_back(bag.string() + ": " + text + "; it is left out");
    return {};
  }
  return Error{.message = text,
               .file = bag.string(),
               .hint = "record with a ROS middleware that serialises as cdr"};
}

}  // namespace

bool SurveyedTopic::has_known_encoding() const {
  return std::find(kKnownEncodings.begin(), kKnownEncodings.end(), topic.encoding) !=
         kKnownEncodings.end();
}

const SurveyedTopic* BagSurvey::find(const std::string& name) const {
  const SurveyedTopic* found = nullptr;
  for (const SurveyedTopic& topic : topics) {
    // Names with and without a leading slash are the same; of topics with several types, the
    // decodable one is found.
    if (frame_name(topic.topic.name) != frame_name(name)) continue;
    if (found == nullptr || found->kind == RosMessageKind::other) found = &topic;
  }
  return found;
}

bool BagSurvey::has_frame(const std::string& frame) const {
  return std::any_of(transforms.begin(), transforms.end(), [&](const auto& entry) {
    return entry.first.first == frame || entry.first.second == frame;
  });
}

Expected<BagSurvey> survey_bag(const std::filesystem::path& bag, const Observer& observer,
                               const CsvOptions& csv) {
  Expected<std::unique_ptr<BagReader>> reader = open_bag_or_csv(bag, csv);
  if (!reader) return reader.error();
  BagSurvey survey;
  survey.csv = csv;
  std::vector<TopicSurveyor> surveyors;
  const auto update = [&] {
    const std::vector<BagTopic>& topics = (*reader)->topics();
    while (surveyors.size() < topics.size()) surveyors.emplace_back(topics[surveyors.size()]);
  };
  for (;;) {
    const Expected<std::optional<BagMessage>> message = (*reader)->next();
    if (!message) return message.error();
    update();
    if (!*message) break;
    const Stamp t = (*message)->log_time;
    if (survey.messages++ == 0) survey.first = survey.last = t;
    survey.first = std::min(survey.first, t);
    survey.last = std::max(survey.last, t);
    surveyors[(*message)->topic].add(**message, survey);
    observer.on_progress("reading", survey.messages, 0);
  }
  survey.warnings = (*reader)->warnings();
  for (TopicSurveyor& surveyor : surveyors) survey.topics.push_back(surveyor.finish());
  std::sort(survey.topics.begin(), survey.topics.end(), [](const auto& a, const auto& b) {
    return std::pair(a.topic.name, a.topic.type) < std::pair(b.topic.name, b.topic.type);
  });
  if (const Expected<void> checked = check_encodings(bag, survey); !checked) return checked.error();
  return survey;
}

bool is_tf_topic(const SurveyedTopic& topic) { return topic.kind == RosMessageKind::transforms; }

bool is_depth_topic(const SurveyedTopic& topic) {
  if (topic.kind == RosMessageKind::image) {
    return topic.image_format == "16UC1" || topic.image_format == "32FC1" ||
           (topic.image_format == "mono16" && topic.topic.name.find("epth") != std::string::npos);
  }
  return topic.kind == RosMessageKind::compressed_image &&
         (topic.image_format.find("compressedDepth") != std::string::npos ||
          topic.image_format.starts_with("16UC1"));
}

bool is_color_topic(const SurveyedTopic& topic) {
  if (topic.kind == RosMessageKind::image) return is_color_encoding(topic.image_format);
  return topic.kind == RosMessageKind::compressed_image && topic.messages > 0 &&
         !is_depth_topic(topic);
}

}  // namespace pcavr
