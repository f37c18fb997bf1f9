// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {
namespace {

constexpr char kSetupFormat[] = "pcavr-ros2/1";
constexpr int kMaxDomain = 232;  // of a higher one the ports exceed 65535 [DDSI-RTPS 9.6.1]
constexpr int kMaxDepth = 1000;
constexpr std::size_t kMaxName = 255;  // bytes, of ROS 2

constexpr InputRange kTimeout{"timeout", 0.01, 3600.0, "s", "from a few samples to an hour"};
constexpr InputRange kRate{"rate", 1.0, 1000.0, "Hz", "at most the site's own"};
constexpr InputRange kDistance{"distance", 1e-4, 1.0, "m", "from a sensor's noise to an arm"};
constexpr InputRange kStd{"standard deviation", 1e-6, 0.1, "m", "of a tracker"};

constexpr InputRange kTime{"time from start", 0.0, 1.0, "s", "some cycles of a controller"};
constexpr InputRange kRotationSpeed{"rotation speed", 1e-3, 10.0, "rad/s", "of an arm's hand"};

constexpr char kPoseType[] = "geometry_msgs/msg/PoseStamped";
constexpr char kJointType[] = "sensor_msgs/msg/JointState";
constexpr char kTrajectoryType[] = "trajectory_msgs/msg/JointTrajectory";
constexpr char kWrenchType[] = "geometry_msgs/msg/WrenchStamped";
constexpr char kTransformType[] = "tf2_msgs/msg/TFMessage";
constexpr char kImageType[] = "sensor_msgs/msg/Image";
constexpr char kCompressedType[] = "sensor_msgs/msg/CompressedImage";
constexpr char kInfoType[] = "sensor_msgs/msg/CameraInfo";

/// [ROS 2 design, "Topic and Service name mapping"].
bool is_topic_name(const std::string& name) {
  if (name.size() < 2 || name.size() > kMaxName || name.front() != '/' || name.back() == '/')
    return false;
  const bool has_plain_letters = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/';
  });
  return has_plain_letters && name.find("//") == std::string::npos;
}

/// A text, or a map with topic, reliability, durability and depth besides the `others`.
Ros2Topic read_topic(const YamlValue& value, const char* type, const Ros2Qos& qos) {
  Ros2Topic topic{value.at("topic").text(), type, qos};
  if (!is_topic_name(topic.name)) {
    value.at("topic").fail("'" + topic.name + "' is not a topic",
                           "write its full name, such as /tool_pose");
  }
  if (const auto given = value.find("reliability")) {
    const std::string text = given->text();
    if (text != "reliable" && text != "best_effort") {
      given->fail("is '" + text + "'", "write reliable or best_effort");
    }
    topic.qos.is_reliable = text == "reliable";
  }
  if (const auto given = value.find("durability")) {
    const std::string text = given->text();
    if (text != "volatile" && text != "transient_local") {
      given->fail("is '" + text + "'", "write volatile or transient_local");
    }
    topic.qos.is_transient_local = text == "transient_local";
  }
  if (const auto given = value.find("depth")) topic.qos.depth = given->integer(1, kMaxDepth);
  return topic;
}

Ros2Topic read_plain_topic(const YamlValue& value, const char* type, const Ros2Qos& qos) {
  value.expect_keys({"topic", "reliability", "durability", "depth"});
  return read_topic(value, type, qos);
}

std::string read_frame(const YamlValue& value) {
  std::string frame = value.text();
  frame.erase(0, std::min(frame.find_first_not_of('/'), frame.size()));
  if (frame.empty() || frame.size() > kMaxName) value.fail("is not a frame", "write a frame_id");
  return frame;
}

void read_network(const YamlValue& value, DdsOptions& dds) {
  value.expect_keys({"interface", "peers", "multicast"});
  if (const auto given = value.find("interface")) dds.interface = given->text();
  if (const auto given = value.find("multicast")) dds.multicast = given->boolean();
  if (const auto given = value.find("peers")) {
    for (const YamlValue& peer : given->items()) dds.peers.push_back(peer.text());
  }
}

std::uint32_t domain_of(const YamlValue& root) {
  if (const auto given = root.find("domain")) {
    return static_cast<std::uint32_t>(given->integer(0, kMaxDomain));
  }
  const Expected<std::uint32_t> domain = environment_domain();
  if (!domain) root.fail(domain.error().message, "correct the environment, or give domain");
  return *domain;
}

void read_tool(const YamlValue& value, const std::filesystem::path& folder, Ros2Setup& setup) {
  value.expect_keys({"topic", "reliability", "durability", "depth", "frame", "urdf", "link"});
  const auto urdf = value.find("urdf");
  setup.tool = read_topic(value, urdf ? kJointType : kPoseType, {.depth = 50});
  if (urdf) {
    setup.tool_urdf = folder / urdf->text();
    setup.tool_link = setup.tool_frame = value.at("link").text();
  } else if (const auto link = value.find("link")) {
    link->fail("needs urdf", "add urdf, or remove it");
  }
  if (const auto frame = value.find("frame")) setup.tool_frame = read_frame(*frame);
}

void read_wrench(const YamlValue& value, Ros2Setup& setup) {
  value.expect_keys({"topic", "reliability", "durability", "depth", "frame", "acts_on"});
  setup.wrench = read_topic(value, kWrenchType, {.depth = 50});
  if (const auto frame = value.find("frame")) setup.wrench_frame = read_frame(*frame);
  if (const auto given = value.find("acts_on")) {
    const std::string text = given->text();
    if (text != "tool" && text != "object")
      given->fail("is '" + text + "'", "write tool or object");
    setup.is_wrench_on_tool = text == "tool";
  }
}

void read_transforms(const YamlValue& value, Ros2Setup& setup) {
  value.expect_keys({"topic", "static_topic", "reliability", "depth"});
  setup.transforms = read_topic(value, kTransformType, {.is_reliable = true, .depth = 100});
  setup.static_transforms = {"/tf_static",
                             kTransformType,
                             {.is_reliable = true, .is_transient_local = true, .depth = 100}};
  if (const auto given = value.find("static_topic")) {
    setup.static_transforms->name = given->text();
    if (!is_topic_name(setup.static_transforms->name)) {
      given->fail("'" + setup.static_transforms->name + "' is not a topic", "write its full name");
    }
  }
}

void read_objects(const YamlValue& value, Ros2Setup& setup) {
  for (const auto& [name, entry] : value.entries()) {
    entry.expect_keys({"topic", "reliability", "durability", "depth", "position_std"});
    Ros2Object object{.name = name, .topic = read_topic(entry, kPoseType, {.depth = 10})};
    if (const auto given = entry.find("position_std")) object.position_std = given->number_in(kStd);
    setup.objects.push_back(std::move(object));
  }
}

void read_camera(const YamlValue& value, const std::filesystem::path& folder, Ros2Setup& setup) {
  value.expect_keys({"image", "info", "frame", "tags"});
  Ros2Camera camera;
  const YamlValue image = value.at("image");
  image.expect_keys({"topic", "reliability", "durability", "depth", "compressed"});
  const auto compressed = image.find("compressed");
  camera.image = read_topic(
      image, compressed && compressed->boolean() ? kCompressedType : kImageType, {.depth = 1});
  camera.info = read_plain_topic(value.at("info"), kInfoType, {.depth = 1});
  if (const auto frame = value.find("frame")) camera.frame = read_frame(*frame);
  camera.tags = folder / value.at("tags").text();
  setup.camera = std::move(camera);
}

/// Whether a key has the second of two words; fails if it has neither.
bool is_second_word(const YamlValue& value, const std::string& first, const std::string& second) {
  const std::string text = value.text();
  if (text != first && text != second) {
    value.fail("is '" + text + "'", "write " + first + " or " + second);
  }
  return text == second;
}

void read_command(const YamlValue& value, Ros2Setup& setup) {
  value.expect_keys({"topic", "reliability", "durability", "depth", "rate", "max_distance", "type",
                     "time_from_start", "orientation", "max_rotation_speed"});
  if (const auto given = value.find("type")) {
    setup.is_command_of_joints = is_second_word(*given, "pose", "joint_trajectory");
    if (setup.is_command_of_joints && setup.tool_urdf.empty()) {
      given->fail("needs the joints of the tool", "give tool.urdf and tool.link");
    }
  }
  setup.command = read_topic(value, setup.is_command_of_joints ? kTrajectoryType : kPoseType,
                             {.is_reliable = true, .depth = 1});
  if (const auto given = value.find("time_from_start"))
    setup.command_time = given->number_in(kTime);
  if (const auto given = value.find("orientation")) {
    setup.follows_orientation = is_second_word(*given, "start", "commanded");
  }
  if (const auto given = value.find("max_rotation_speed")) {
    setup.max_command_rotation = given->number_in(kRotationSpeed);
  }
  if (const auto given = value.find("rate")) setup.command_rate = given->number_in(kRate);
  if (const auto given = value.find("max_distance")) {
    setup.max_command_distance = given->number_in(kDistance);
  }
}

/// What a file has of the network and the frame, with or without a robot.
void read_common(const YamlValue& root, DdsOptions& dds, std::string& base_frame) {
  root.expect_keys({"format", "domain", "network", "base_frame", "start_timeout", "silence_timeout",
                    "tool", "wrench", "transforms", "objects", "camera", "command", "publish"});
  if (root.at("format").text() != kSetupFormat) {
    root.at("format").fail("is not " + std::string(kSetupFormat), "see docs/ros2.md");
  }
  dds.domain = domain_of(root);
  if (const auto given = root.find("network")) read_network(*given, dds);
  if (const auto given = root.find("base_frame")) base_frame = read_frame(*given);
}

/// The section publish, in `common`'s network and frame.
std::optional<Ros2Publication> publish_section(const YamlValue& root, Ros2Publication common) {
  const auto value = root.find("publish");
  if (!value) return std::nullopt;
  Ros2Publication publication = std::move(common);
  value->expect_keys({"prefix", "rate"});
  if (const auto given = value->find("prefix")) {
    publication.prefix = given->text();
    if (!is_topic_name(publication.prefix)) {
      given->fail("'" + publication.prefix + "' does not begin topics",
                  "write a name such as /pcavr");
    }
  }
  if (const auto given = value->find("rate")) publication.rate = given->number_in(kRate);
  return publication;
}

std::optional<Ros2Publication> read_publication(const YamlValue& root) {
  Ros2Publication common;
  read_common(root, common.dds, common.base_frame);
  return publish_section(root, std::move(common));
}

Ros2Setup read_setup(const YamlValue& root, const std::filesystem::path& folder) {
  Ros2Setup setup;
  read_common(root, setup.dds, setup.base_frame);
  setup.publication = publish_section(root, {.dds = setup.dds, .base_frame = setup.base_frame});
  if (const auto given = root.find("start_timeout"))
    setup.start_timeout = given->number_in(kTimeout);
  if (const auto given = root.find("silence_timeout")) {
    setup.silence_timeout = given->number_in(kTimeout);
  }
  read_tool(root.at("tool"), folder, setup);
  if (const auto given = root.find("wrench")) read_wrench(*given, setup);
  if (const auto given = root.find("transforms")) read_transforms(*given, setup);
  if (const auto given = root.find("objects")) read_objects(*given, setup);
  if (const auto given = root.find("camera")) read_camera(*given, folder, setup);
  if (const auto given = root.find("command")) read_command(*given, setup);
  return setup;
}

}  // namespace

std::vector<Ros2Subscription> subscriptions_of(const Ros2Setup& setup) {
  std::vector<Ros2Subscription> found{{setup.tool, Ros2Subscription::Role::tool}};
  if (setup.wrench) found.push_back({*setup.wrench, Ros2Subscription::Role::wrench});
  if (setup.transforms) found.push_back({*setup.transforms, Ros2Subscription::Role::transforms});
  if (setup.static_transforms)
    found.push_back({*setup.static_transforms, Ros2Subscription::Role::transforms});
  for (std::size_t i = 0; i < setup.objects.size(); ++i) {
    found.push_back({setup.objects[i].topic, Ros2Subscription::Role::object, i});
  }
  if (setup.camera) found.push_back({setup.camera->image, Ros2Subscription::Role::image});
  if (setup.camera) found.push_back({setup.camera->info, Ros2Subscription::Role::camera_info});
  return found;
}

Expected<std::uint32_t> environment_domain() {
  const char* const text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0U;
  char* end = nullptr;
  const long domain = std::strtol(text, &end, 10);
  if (*end == '\0' && domain >= 0 && domain <= kMaxDomain) {
    return static_cast<std::uint32_t>(domain);
  }
  return Error{
      .message = "ROS_DOMAIN_ID is '" + std::string(text) + "', not an integer from 0 to 232",
      .hint = "correct the environment"};
}

Expected<Ros2Setup> parse_ros2_setup(const std::string& text, const std::filesystem::path& file) {
  return parse_yaml<Ros2Setup>(text, file.string(), [&](const YamlValue& root) {
    return read_setup(root, file.parent_path());
  });
}

Expected<Ros2Publication> read_ros2_publication(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  const Expected<std::optional<Ros2Publication>> read =
      parse_yaml<std::optional<Ros2Publication>>(*text, file.string(), read_publication);
  if (!read) return read.error();
  if (*read) return **read;
  return Error{.message = "has nothing to publish",
               .file = file.string(),
               .hint = "add the section publish: see docs/ros2.md"};
}

Expected<Ros2Setup> read_ros2_setup(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_ros2_setup(*text, file);
}

}  // namespace pcavr
