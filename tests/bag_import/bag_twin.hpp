// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include "support/ros1_bag_text.hpp"
#include "support/ros_encoder.hpp"

namespace pcavr::test {

/// A small recording as functions of time, and as a bag in which it arrives as robots send it:
/// forces in the axes of a sensor on a moving arm, objects in a tracker's frame, out of order.
struct BagTwin {
  static constexpr int kWidth = 32, kHeight = 24, kFrames = 5, kSamples = 100;
  static constexpr std::int64_t kStart = 1'700'000'000'000'000'000;

  static Stamp sample_stamp(int i) { return {kStart + 10'000'000LL * i}; }
  static Stamp frame_stamp(int i) { return {kStart + 100'000'000LL + 33'000'000LL * i}; }
  static double seconds(Stamp stamp) { return to_seconds(stamp - Stamp{kStart}); }

  static Pose T_base_flange(Stamp stamp) {
    const double t = seconds(stamp);
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * t, Eigen::Vector3d::UnitZ())),
                Eigen::Vector3d(0.4 + 0.1 * t, 0.0, 0.3));
  }
  static Pose T_flange_tip() { return Pose::from_translation({0.0, 0.0, -0.1}); }
  static Pose T_base_tip(Stamp stamp) { return T_base_flange(stamp) * T_flange_tip(); }
  static Pose T_base_tracker() {
    return Pose(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), Eigen::Vector3d(0.1, 0.2, 1.5));
  }
  static Pose T_base_camera() {
    return Pose(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), Eigen::Vector3d(0.5, 0.0, 1.0));
  }
  static Pose T_base_box(Stamp stamp) {
    return Pose::from_translation({0.5 + 0.05 * seconds(stamp), 0.1, 0.05});
  }
  /// Force on the surroundings, at the tip, in base axes.
  static Eigen::Vector3d force(Stamp stamp) { return {std::sin(seconds(stamp)), 2.0, -5.0}; }
  static Eigen::Vector3d torque(Stamp stamp) { return {0.1, 0.02 * seconds(stamp), 0.3}; }
  static std::uint16_t depth(int frame, int x, int y) {
    return static_cast<std::uint16_t>(x == 0 ? 0 : 800 + 10 * frame + x + y);
  }
  static Rgb8 color(int x, int y) {
    return {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(4 * y), 90};
  }

  struct Message {
    std::string topic, type;
    Stamp log_time;
    std::string payload;
  };

  static std::vector<Message> messages(RosEncoder::Format format);
  static void write_mcap(const std::filesystem::path& file, const std::vector<Message>& messages) {
    Expected<McapWriter> writer = McapWriter::create(file, {.profile = "ros2", .replace = true});
    std::map<std::string, std::uint16_t> channels;
    for (const Message& message : messages) {
      if (!channels.contains(message.topic)) {
        std::string type = message.type;
        type.insert(type.find('/'), "/msg");
        const std::uint16_t schema = writer->add_schema(type, "ros2msg", "");
        channels[message.topic] = writer->add_channel(message.topic, "cdr", schema);
      }
      (void)writer->write(channels[message.topic], message.log_time, message.payload);
    }
    (void)writer->close();
  }
  static void write_ros1(const std::filesystem::path& file, const std::vector<Message>& messages) {
    Ros1BagText text;
    for (const Message& m : messages) text.add(m.topic, m.type, m.log_time, m.payload);
    (void)write_file(file, text.bag());
  }
};

inline std::vector<BagTwin::Message> BagTwin::messages(RosEncoder::Format format) {
  std::vector<Message> all;
  const auto add = [&](const char* topic, const char* type, Stamp stamp,
                       const RosEncoder& encoder) {
    // 2 ms from the sensor to the recorder.
    all.push_back({topic, type, stamp + std::chrono::milliseconds(2), encoder.bytes()});
  };
  const auto encoder = [&] { return RosEncoder(format); };
  RosEncoder fixed = encoder();
  fixed.number(std::uint32_t{3}).transform({kStart}, "base_link", "tracker", T_base_tracker());
  fixed.transform({kStart}, "/flange", "/tip", T_flange_tip());
  fixed.transform({kStart}, "base_link", "camera_optical", T_base_camera());
  add("/tf_static", "tf2_msgs/TFMessage", {kStart}, fixed);
  for (int i = 0; i < kSamples; ++i) {
    const Stamp t = sample_stamp(i);
    RosEncoder tf = encoder();
    tf.number(std::uint32_t{1}).transform(t, "base_link", "flange", T_base_flange(t));
    add("/tf", "tf2_msgs/TFMessage", t, tf);
    // The force on the tip as a sensor in the flange measures it.
    const Pose T_base_sensor = T_base_flange(t);
    const Eigen::Vector3d arm = T_base_tip(t).translation() - T_base_sensor.translation();
    const Eigen::Vector3d torque_at_sensor = torque(t) + arm.cross(force(t));
    const Eigen::Quaterniond R_sensor_base = T_base_sensor.rotation().conjugate();
    add("/ft", "geometry_msgs/WrenchStamped", t,
        encoder()
            .header(t, "/flange")
            .vector(R_sensor_base * force(t))
            .vector(R_sensor_base * torque_at_sensor));
    add("/mocap/box", "geometry_msgs/TransformStamped", t,
        encoder().transform(t, "tracker", "box", T_base_tracker().inverse() * T_base_box(t)));
    RosEncoder joints = encoder();
    joints.header(t, "")
        .number(std::uint32_t{1})
        .text("j1")
        .doubles({0.3 * seconds(t)})
        .doubles({})
        .doubles({});
    add("/joint_states", "sensor_msgs/JointState", t, joints);
  }
  for (int i = 0; i < kFrames; ++i) {
    const Stamp t = frame_stamp(i);
    std::string depths, colors;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        depths += Ros1BagText::number(depth(i, x, y), 2);
        const Rgb8 c = color(x, y);
        colors += {static_cast<char>(c.b), static_cast<char>(c.g), static_cast<char>(c.r)};
      }
    }
    add("/cam/color/image_raw", "sensor_msgs/Image", t,
        encoder().image(t, "camera_optical", kWidth, kHeight, "bgr8", colors));
    add("/cam/aligned_depth_to_color/image_raw", "sensor_msgs/Image", t,
        encoder().image(t, "camera_optical", kWidth, kHeight, "16UC1", depths));
    add("/cam/color/camera_info", "sensor_msgs/CameraInfo", t,
        encoder().camera_info(t, "camera_optical", kWidth, kHeight, 30.0, 15.5, 11.5));
  }
  // Two forces are swapped and one is sent twice, as by networks.
  std::vector<std::size_t> forces;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].topic == "/ft") forces.push_back(i);
  }
  std::swap(all[forces[10]], all[forces[11]]);
  all.push_back(all[forces[20]]);
  return all;
}

}  // namespace pcavr::test
