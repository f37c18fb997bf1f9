// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/forked.hpp"

namespace pcavr {
namespace {

using namespace std::chrono_literals;

constexpr char kPose[] = "geometry_msgs/msg/PoseStamped";
constexpr char kWrench[] = "geometry_msgs/msg/WrenchStamped";

TEST(Ros2Names, AreThoseOfRos2InDds) {
  EXPECT_EQ(dds_topic_name("/tool"), "rt/tool");
  EXPECT_EQ(dds_type_name(kPose), "geometry_msgs::msg::dds_::PoseStamped_");
  EXPECT_EQ(ros_type_name("geometry_msgs::msg::dds_::PoseStamped_"), kPose);
  EXPECT_EQ(ros_type_name("Shapes"), "Shapes");
}

/// Waits for up to 10 s, until `is_done`.
template <typename Done>
void receive_until(Ros2Transport& transport, const Ros2Transport::Receiver& receive, Done is_done) {
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!is_done() && std::chrono::steady_clock::now() < end) transport.wait(20ms, receive);
}

TEST(DdsTransport, PassesTheBytesOfAnotherProcessUnchanged) {
  const DdsOptions options = loopback_options();
  const Ros2Topic topic{"/tool", kPose, {.depth = 10}};
  const auto sent = cdr::pose_stamped({1'700'000'000'123'456'789}, Pose(), "base_link");
  const ForkedProcess peer([&] {
    ForkedProcess::report_ready();
    auto transport = open_dds({}, {topic}, options);
    while (transport && (*transport)->publish(0, sent)) std::this_thread::sleep_for(10ms);
  });
  auto transport = open_dds({topic}, {}, options);
  if (!transport) GTEST_SKIP() << "no DDS on this network: " << transport.error().to_string();
  std::vector<std::uint8_t> received;
  receive_until(
      **transport,
      [&](std::size_t at, std::span<const std::uint8_t> message) {
        EXPECT_EQ(at, 0U);
        received.assign(message.begin(), message.end());
      },
      [&] { return !received.empty(); });
  EXPECT_EQ(received, sent);
}

TEST(DdsTransport, NamesAPeerWithAnotherTypeOrQualityOfService) {
  const DdsOptions options = loopback_options();
  const Ros2Topic tool{"/tool", kPose, {}};
  const Ros2Topic wrench{"/wrench", kWrench, {.is_reliable = true}};
  const ForkedProcess peer([&] {
    ForkedProcess::report_ready();
    auto transport = open_dds({}, {{"/tool", kWrench, {}}, {"/wrench", kWrench, {}}}, options);
    while (transport) std::this_thread::sleep_for(100ms);
  });
  auto transport = open_dds({tool, wrench}, {}, options);
  if (!transport) GTEST_SKIP() << "no DDS on this network: " << transport.error().to_string();
  std::string notices;
  const auto has = [&](const char* text) { return notices.find(text) != std::string::npos; };
  receive_until(
      **transport, [](std::size_t, std::span<const std::uint8_t>) { ADD_FAILURE(); },
      [&] {
        for (const std::string& line : (*transport)->take_notices()) notices += line + '\n';
        return has("/tool") && has("/wrench");
      });
  EXPECT_TRUE(
      has("/tool is published with type geometry_msgs/msg/WrenchStamped, not "
          "geometry_msgs/msg/PoseStamped: ignored"))
      << notices;
  EXPECT_TRUE(has("/wrench: a publisher has an incompatible quality of service (reliability"))
      << notices;
}

TEST(DdsTransport, DropsAMessageBeyondTheLimit) {
  DdsOptions options = loopback_options();
  const Ros2Topic topic{"/tool", kPose, {.depth = 10}};
  const std::vector<std::uint8_t> small(1000, 7);
  const ForkedProcess peer([&] {
    ForkedProcess::report_ready();
    auto transport = open_dds({}, {topic}, options);
    const std::vector<std::uint8_t> large(200'000, 9);
    while (transport) {
      (void)(*transport)->publish(0, large);
      (void)(*transport)->publish(0, small);
      std::this_thread::sleep_for(20ms);
    }
  });
  options.max_message = 100'000;
  auto transport = open_dds({topic}, {}, options);
  if (!transport) GTEST_SKIP() << "no DDS on this network: " << transport.error().to_string();
  int count = 0;
  receive_until(
      **transport,
      [&](std::size_t, std::span<const std::uint8_t> message) {
        EXPECT_EQ(message.size(), small.size());
        ++count;
      },
      [&] { return count >= 5; });
  EXPECT_GE(count, 5);
}

}  // namespace
}  // namespace pcavr
