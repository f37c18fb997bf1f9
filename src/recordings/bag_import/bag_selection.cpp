// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/bag_selection.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <set>

#include "recordings/bag_import/near_names.hpp"

namespace pcavr {
namespace {

using TopicTest = std::function<bool(const SurveyedTopic&)>;
using Candidates = std::vector<const SurveyedTopic*>;

bool name_contains(const SurveyedTopic& topic, std::initializer_list<std::string_view> parts) {
  std::string name = topic.topic.name;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(parts.begin(), parts.end(),
                     [&](std::string_view part) { return name.find(part) != name.npos; });
}

bool is_pose(const SurveyedTopic& topic) {
  return topic.kind == RosMessageKind::pose || topic.kind == RosMessageKind::point ||
         topic.kind == RosMessageKind::transform;
}

/// The last part of a topic's name.
std::string own_name(const SurveyedTopic& topic) {
  return topic.topic.name.substr(topic.topic.name.rfind('/') + 1);
}

/// The number of parts that two topics' names have in common from the start.
std::size_t common_parts(const SurveyedTopic& first, const SurveyedTopic& second,
                         std::string_view separators = "/") {
  const std::string a = frame_name(first.topic.name) + '/';
  const std::string b = frame_name(second.topic.name) + '/';
  const auto end = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first;
  return static_cast<std::size_t>(
      std::count_if(a.begin(), end, [&](char c) { return separators.find(c) != separators.npos; }));
}

bool is_camera_info(const SurveyedTopic& topic) {
  return topic.kind == RosMessageKind::camera_info;
}

/// Keeps those that pass the test, if there are any.
void prefer(Candidates& candidates, const TopicTest& test) {
  Candidates preferred;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(preferred),
               [&](const SurveyedTopic* topic) { return test(*topic); });
  if (!preferred.empty()) candidates = std::move(preferred);
}

class TopicSelector {
 public:
  TopicSelector(const std::filesystem::path& bag, const BagSurvey& survey,
                const BagTopicOptions& options)
      : bag_(bag), survey_(survey), options_(options) {}

  Expected<BagSelection> run() {
    for (const auto step : {&TopicSelector::select_images, &TopicSelector::select_series,
                            &TopicSelector::select_objects, &TopicSelector::select_base}) {
      if (const Expected<void> done = (this->*step)(); !done) return done.error();
    }
    note_unread_images();
    return selection_;
  }

 private:
  /// The topic that one option asks for.
  struct Wanted {
    std::string option;  ///< "--tool-topic"
    std::string name;    ///< as given; empty: choose
    std::string types;   ///< for messages
    TopicTest is_usable;
  };

  Candidates candidates_of(const TopicTest& test) const {
    Candidates candidates;
    for (const SurveyedTopic& topic : survey_.topics) {
      const bool is_readable =
          is_decodable_encoding(topic.topic.encoding) && topic.messages > topic.undecodable;
      if (is_readable && test(topic)) candidates.push_back(&topic);
    }
    return candidates;
  }

  Expected<const SurveyedTopic*> named(const Wanted& wanted) const {
    const SurveyedTopic* topic = survey_.find(wanted.name);
    if (topic == nullptr) {
      std::vector<std::string> names;
      for (const SurveyedTopic* other : candidates_of(wanted.is_usable)) {
        names.push_back(other->topic.name);
      }
      return Error{.message = "topic '" + wanted.name + "' is not in the bag",
                   .file = bag_.string(),
                   .place = wanted.option,
                   .hint = near_names_hint(wanted.name, names)};
    }
    if (topic->messages > 0 && !wanted.is_usable(*topic)) {
      return Error{.message = "topic '" + wanted.name + "' is of type " + topic->topic.type +
                              (topic->image_format.empty() ? "" : " (" + topic->image_format + ")"),
                   .file = bag_.string(),
                   .place = wanted.option,
                   .hint = "it takes " + wanted.types};
    }
    if (topic->messages > topic->undecodable) return topic;
    return Error{.message = "topic '" + wanted.name + "' has no message" +
                            (topic->messages == 0 ? "" : " that can be decoded: " + topic->problem),
                 .file = bag_.string(),
                 .place = wanted.option};
  }

  /// The named topic, or the only candidate; nullptr and a note where there are several.
  Expected<void> select(const Wanted& wanted, Candidates candidates,
                        const SurveyedTopic*& selected) {
    if (!wanted.name.empty()) {
      const Expected<const SurveyedTopic*> topic = named(wanted);
      if (!topic) return topic.error();
      selected = *topic;
    } else if (candidates.size() == 1) {
      selected = candidates.front();
    } else if (candidates.size() > 1) {
      std::string names;
      for (const SurveyedTopic* topic : candidates) {
        names += (names.empty() ? "" : ", ") + topic->topic.name;
      }
      selection_.notes.push_back("several topics could be taken: " + names + "; choose with " +
                                 wanted.option);
    }
    return {};
  }

  Expected<void> select_images() {
    const Wanted depth{"--depth-topic", options_.depth_topic,
                       "sensor_msgs/Image of 16UC1 or 32FC1, or CompressedImage of compressedDepth",
                       is_depth_topic};
    Candidates candidates = candidates_of(is_depth_topic);
    prefer(candidates, [](const SurveyedTopic& topic) {
      return name_contains(topic, {"aligned_depth", "depth_registered", "registered"});
    });
    prefer(candidates, [](const SurveyedTopic& t) { return t.kind == RosMessageKind::image; });
    if (const auto done = select(depth, candidates, selection_.depth); !done) return done;
    // Where several topics may be the depth, that is to be chosen first.
    if (selection_.depth == nullptr && !candidates.empty()) return {};
    if (options_.color_topic == "none") {
      return selection_.depth != nullptr ? select_camera_info() : Expected<void>();
    }
    const Wanted color{"--colour-topic", options_.color_topic,
                       "sensor_msgs/Image of rgb8, bgr8, rgba8, bgra8, mono8, bayer_*8 or yuv422, "
                       "or CompressedImage",
                       is_color_topic};
    candidates = candidates_of(is_color_topic);
    prefer(candidates, [](const SurveyedTopic& t) {
      return name_contains(t, {"rgb", "color", "colour"});
    });
    prefer(candidates, [&](const SurveyedTopic& t) {
      return selection_.depth == nullptr || t.frames == selection_.depth->frames;
    });
    prefer(candidates, [](const SurveyedTopic& t) { return t.kind == RosMessageKind::image; });
    prefer(candidates, [](const SurveyedTopic& t) { return !name_contains(t, {"mono", "infra"}); });
    if (const auto done = select(color, candidates, selection_.color); !done) return done;
    return selection_.images() != nullptr ? select_camera_info() : Expected<void>();
  }

  /// Selects the camera info whose name is nearest to the images'.
  Expected<void> select_camera_info() {
    Candidates candidates = candidates_of(is_camera_info);
    const SurveyedTopic* image = selection_.color != nullptr ? selection_.color : selection_.depth;
    std::size_t parts = 0;
    for (const SurveyedTopic* info : candidates)
      parts = std::max(parts, common_parts(*info, *image));
    prefer(candidates,
           [&](const SurveyedTopic& info) { return common_parts(info, *image) == parts; });
    const auto done = select({"--camera-info-topic", options_.camera_info_topic,
                              "sensor_msgs/CameraInfo", is_camera_info},
                             candidates, selection_.camera_info);
    if (!done) return done;
    if (selection_.depth == nullptr) return {};
    selection_.depth_info = own_depth_info("/");
    // Names without folders; depth_registered shares a word with the depth that it is not.
    const bool is_plain_depth = !name_contains(*selection_.depth, {"registered", "aligned"});
    if (selection_.depth_info == nullptr && is_plain_depth) {
      selection_.depth_info = own_depth_info("/_");
    }
    return {};
  }

  /// The camera info that is nearer to depth by its name than colour is; nullptr where there is
  /// none, or it is already taken.
  const SurveyedTopic* own_depth_info(std::string_view separators) const {
    if (selection_.color == nullptr) return nullptr;
    const auto parts = [&](const SurveyedTopic& a, const SurveyedTopic& b) {
      return common_parts(a, b, separators);
    };
    const SurveyedTopic* own = nullptr;
    std::size_t most = parts(*selection_.color, *selection_.depth);
    for (const SurveyedTopic* info : candidates_of(is_camera_info)) {
      const std::size_t common = parts(*info, *selection_.depth);
      if (common <= most || common <= parts(*info, *selection_.color)) continue;
      most = common;
      own = info;
    }
    return own == selection_.camera_info ? nullptr : own;
  }

  /// Images that are neither depth nor colour by their encoding, where one of these is missing.
  void note_unread_images() {
    const bool is_color_wanted = options_.color_topic != "none";
    if (selection_.depth != nullptr && (selection_.color != nullptr || !is_color_wanted)) return;
    for (const SurveyedTopic* topic : candidates_of([](const SurveyedTopic& t) {
           return t.kind == RosMessageKind::image && !is_depth_topic(t) && !is_color_topic(t);
         })) {
      selection_.unread_images.push_back(topic->topic.name + " is " + topic->image_format +
                                         ", which is not read");
      selection_.notes.push_back(selection_.unread_images.back() +
                                 "; republish it as rgb8 or 16UC1");
    }
  }

  Expected<void> select_series() {
    if (!options_.tool_topic.empty() && !options_.tool_frame.empty()) {
      return Error{.message = "can't be combined with --tool-topic",
                   .place = "--tool-frame",
                   .hint = "give one of them"};
    }
    const char* poses =
        "PoseStamped, PoseWithCovarianceStamped, PointStamped, TransformStamped or Odometry";
    if (!options_.camera_pose_topic.empty()) {
      const auto done = select({"--camera-pose-topic", options_.camera_pose_topic, poses, is_pose},
                               {}, selection_.camera_pose);
      if (!done) return done;
    }
    if (options_.tool_frame.empty()) {
      const auto done = select({"--tool-topic", options_.tool_topic, poses, is_pose},
                               tool_candidates(), selection_.tool);
      if (!done) return done;
    }
    const auto is_wrench = [](const SurveyedTopic& t) { return t.kind == RosMessageKind::wrench; };
    auto done =
        select({"--wrench-topic", options_.wrench_topic, "geometry_msgs/WrenchStamped", is_wrench},
               candidates_of(is_wrench), selection_.wrench);
    if (!done) return done;
    const auto is_joints = [](const SurveyedTopic& t) {
      return t.kind == RosMessageKind::joint_state;
    };
    Candidates candidates = candidates_of(is_joints);
    prefer(candidates,
           [](const SurveyedTopic& t) { return frame_name(t.topic.name) == "joint_states"; });
    return select({"--joint-topic", options_.joint_topic, "sensor_msgs/JointState", is_joints},
                  candidates, selection_.joints);
  }

  /// Poses and points that are not a camera's, and not given for something else.
  Candidates tool_candidates() const {
    Candidates candidates = candidates_of([&](const SurveyedTopic& topic) {
      const bool is_taken =
          std::any_of(options_.objects.begin(), options_.objects.end(), [&](const auto& object) {
            return frame_name(object.second) == frame_name(topic.topic.name);
          });
      const bool is_stamped_pose =
          topic.kind == RosMessageKind::point || topic.topic.type.ends_with("PoseStamped");
      return is_stamped_pose && !is_taken && !has_object_name(topic) &&
             &topic != selection_.camera_pose && !name_contains(topic, {"camera", "slam", "goal"});
    });
    prefer(candidates, [](const SurveyedTopic& topic) {
      return name_contains(topic, {"tip", "tcp", "tool", "ee_pose", "eef", "end_effector"});
    });
    return candidates;
  }

  [[nodiscard]] bool has_object_name(const SurveyedTopic& topic) const {
    return options_.objects.empty() && topic.kind != RosMessageKind::point &&
           options_.object_names.contains(own_name(topic));
  }

  Expected<void> select_objects() {
    std::set<std::string> names;
    for (const auto& [name, topic] : options_.objects) {
      const SurveyedTopic* selected = nullptr;
      const auto done = select(
          {"--object", topic, "poses: PoseStamped, TransformStamped or Odometry",
           [](const SurveyedTopic& t) { return is_pose(t) && t.kind != RosMessageKind::point; }},
          {}, selected);
      if (!done) return done;
      if (!names.insert(name).second) {
        return Error{.message = "object '" + name + "' is given twice", .place = "--object"};
      }
      selection_.objects.emplace_back(name, selected);
    }
    for (const SurveyedTopic& topic : survey_.topics) {
      const bool is_lost = topic.undecodable > 0 && topic.undecodable == topic.messages;
      if (is_lost)
        selection_.notes.push_back(topic.topic.name + " can't be decoded: " + topic.problem);
    }
    if (!options_.objects.empty()) return {};
    for (const SurveyedTopic* topic : candidates_of([this](const SurveyedTopic& t) {
           return t.kind == RosMessageKind::transform || (is_pose(t) && has_object_name(t));
         })) {
      const bool is_taken = topic == selection_.tool || topic == selection_.camera_pose;
      std::string name = own_name(*topic);
      if (!is_taken && names.insert(name).second) selection_.objects.emplace_back(name, topic);
    }
    return {};
  }

  Expected<void> check_frame(const std::string& option, const std::string& frame) const {
    std::set<std::string> frames;
    for (const auto& [link, count] : survey_.transforms) {
      frames.insert(link.first);
      frames.insert(link.second);
    }
    for (const SurveyedTopic& topic : survey_.topics) {
      frames.insert(topic.frames.begin(), topic.frames.end());
    }
    if (frames.contains(frame)) return {};
    return Error{.message = "frame '" + frame + "' is not in the bag",
                 .file = bag_.string(),
                 .place = option,
                 .hint = near_names_hint(frame, {frames.begin(), frames.end()})};
  }

  Expected<void> select_base() {
    if (!options_.tool_frame.empty()) {
      const auto there = check_frame("--tool-frame", frame_name(options_.tool_frame));
      if (!there) return there;
    }
    selection_.base_frame = frame_name(options_.base_frame);
    selection_.is_base_frame_given = !selection_.base_frame.empty();
    if (selection_.is_base_frame_given) return check_frame("--base-frame", selection_.base_frame);
    if (selection_.tool != nullptr) {
      for (const std::string& frame : selection_.tool->frames) {
        if (selection_.base_frame.empty()) selection_.base_frame = frame;
      }
    }
    if (!selection_.base_frame.empty()) return {};
    for (const char* name : {"base_link", "base", "panda_link0", "fr3_link0", "robot_base",
                             "base_footprint", "world", "map", "odom"}) {
      if (selection_.base_frame.empty() && survey_.has_frame(name)) selection_.base_frame = name;
    }
    return {};
  }

  const std::filesystem::path& bag_;
  const BagSurvey& survey_;
  const BagTopicOptions& options_;
  BagSelection selection_;
};

}  // namespace

bool BagSelection::is_empty(const BagTopicOptions& options) const {
  return images() == nullptr && tool == nullptr && wrench == nullptr && joints == nullptr &&
         camera_pose == nullptr && objects.empty() && options.tool_frame.empty();
}

std::string BagSelection::use_of(const SurveyedTopic& topic) const {
  if (&topic == depth) return "depth";
  if (&topic == color) return "colour";
  if (&topic == camera_info) return "camera";
  if (&topic == depth_info) return "depth's camera";
  if (&topic == camera_pose) return "camera poses";
  if (&topic == tool) return "tool";
  if (&topic == wrench) return "wrench";
  if (&topic == joints) return "joints";
  for (const auto& [name, taken] : objects) {
    if (&topic == taken) return "object " + name;
  }
  return is_tf_topic(topic) && topic.messages > 0 ? "frames" : "";
}

Expected<BagSelection> select_bag_topics(const std::filesystem::path& bag, const BagSurvey& survey,
                                         const BagTopicOptions& options) {
  return TopicSelector(bag, survey, options).run();
}

}  // namespace pcavr
