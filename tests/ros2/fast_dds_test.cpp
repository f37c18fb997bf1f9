// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/forked.hpp"
#include "support/ros_encoder.hpp"
#include "support/shared_data.hpp"

#ifndef PCAVR_FAST_DDS_PEER
#define PCAVR_FAST_DDS_PEER ""
#endif

namespace pcavr {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

/// Sends each message through Fast DDS in another process and back; what came back, in order. Empty
/// where there is no network.
std::vector<Bytes> echoed_by_fast_dds(const std::string& type, const std::vector<Bytes>& messages) {
  DdsOptions options = loopback_options();
  static std::uint32_t used = 0;
  options.domain += ++used;  // a domain each: of an earlier peer nothing is left
  const std::string domain = std::to_string(options.domain);
  const std::string dds_type = dds_type_name(type);
  const ForkedProcess peer([&] {
    ForkedProcess::report_ready();
    ::execl(PCAVR_FAST_DDS_PEER, PCAVR_FAST_DDS_PEER, domain.c_str(), dds_type.c_str(), nullptr);
  });
  const Ros2Qos qos{.is_reliable = true, .depth = 10};
  auto transport = open_dds({{"/tool", type, qos}}, {{"/command", type, qos}}, options);
  if (!transport) return {};
  std::vector<Bytes> received;
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (received.size() < messages.size() && std::chrono::steady_clock::now() < end) {
    // The next one when the last is back; again where it was sent before both had found each other.
    (void)(*transport)->publish(0, messages[received.size()]);
    const std::size_t before = received.size();
    const auto retry = std::chrono::steady_clock::now() + 200ms;
    while (received.size() == before && std::chrono::steady_clock::now() < retry) {
      (*transport)->wait(10ms, [&](std::size_t, std::span<const std::uint8_t> bytes) {
        received.emplace_back(bytes.begin(), bytes.end());
      });
    }
  }
  return received;
}

TEST(FastDds, ReadsAndWritesTheSameBytes) {
  if (std::string(PCAVR_FAST_DDS_PEER).empty()) GTEST_SKIP() << "built without libfastrtps-dev";
  std::vector<Bytes> sent;
  for (int i = 0; i < 20; ++i) {
    sent.push_back(cdr::pose_stamped({1'700'000'000'000'000'000 + i},
                                     Pose::from_translation({0.1 * i, 0, 0}),
                                     std::string(static_cast<std::size_t>(i), 'f')));
  }
  EXPECT_EQ(echoed_by_fast_dds("geometry_msgs/msg/PoseStamped", sent), sent);
  // Field by field: header, names, points, and in a point positions, velocities, accelerations,
  // efforts, time [trajectory_msgs].
  RosEncoder fields(RosEncoder::Format::cdr);
  fields.header({}, "").number(std::uint32_t{2}).text("shoulder").text("elbow");
  fields.number(std::uint32_t{1}).doubles({0.25, -1.5}).doubles({}).doubles({}).doubles({});
  const std::string text =
      fields.number(std::int32_t{1}).number(std::uint32_t{500'000'000}).bytes();
  const Bytes trajectory = cdr::joint_trajectory({}, {"shoulder", "elbow"}, {0.25, -1.5}, 1.5);
  EXPECT_EQ(trajectory, Bytes(text.begin(), text.end()));
  EXPECT_EQ(echoed_by_fast_dds("trajectory_msgs/msg/JointTrajectory", {trajectory}),
            std::vector<Bytes>{trajectory});
  // Messages beyond a datagram of UDP are sent in fragments.
  const std::vector<Bytes> large(2, Bytes(300'000, 7));
  EXPECT_EQ(echoed_by_fast_dds("sensor_msgs/msg/Image", large), large);
}

/// The first messages of each topic, by type.
std::map<std::string, std::vector<Bytes>> recorded_messages(const std::string& bag) {
  constexpr std::size_t kMaxMessages = 20;
  std::map<std::string, std::vector<Bytes>> found;
  auto reader = open_bag(shared_data("real/bags/" + bag));
  if (!reader) return found;
  while (true) {
    const auto message = (*reader)->next();
    if (!message || !*message) return found;
    const BagTopic& topic = (*reader)->topics().at((*message)->topic);
    std::vector<Bytes>& messages = found[topic.type];
    if (messages.size() < kMaxMessages) {
      messages.emplace_back((*message)->payload.begin(), (*message)->payload.end());
    }
  }
}

// Messages that ROS 2 has recorded go through both implementations unchanged, and our encoder
// writes them.
TEST(FastDds, PassesRecordedMessagesUnchanged) {
  PCAVR_NEEDS_SHARED_DATA("real/bags/rosbag2_test");
  if (std::string(PCAVR_FAST_DDS_PEER).empty()) GTEST_SKIP() << "built without libfastrtps-dev";
  std::size_t count = 0;
  std::size_t encoded = 0;
  for (const char* const bag : {"rosbag2_test", "delay_mcap/rosbag2_2025_12_05-15_04_38"}) {
    for (const auto& [type, messages] : recorded_messages(bag)) {
      EXPECT_EQ(echoed_by_fast_dds(type, messages), messages) << type;
      count += messages.size();
      if (type != "geometry_msgs/msg/PoseStamped") continue;
      for (Bytes message : messages) {
        // This recorder's orientations are (5, 6, 7, 8), which no reader of ours accepts: replaced.
        const std::array<double, 4> unit{0.0, 0.0, 0.0, 1.0};
        std::memcpy(message.data() + message.size() - sizeof(unit), unit.data(), sizeof(unit));
        const auto decoded = decode_ros_message({"/pose", type, "cdr", {}, {}}, message);
        ASSERT_TRUE(decoded) << decoded.error().to_string();
        const auto& pose = std::get<RosPose>(*decoded);
        ASSERT_TRUE(pose.header.stamp && pose.orientation);
        EXPECT_EQ(cdr::pose_stamped(*pose.header.stamp, Pose(*pose.orientation, pose.position),
                                    pose.header.frame),
                  message);
        ++encoded;
      }
    }
  }
  EXPECT_GE(count, 40U);
  EXPECT_GE(encoded, 10U);
  RecordProperty("messages", static_cast<int>(count));
}

}  // namespace
}  // namespace pcavr
