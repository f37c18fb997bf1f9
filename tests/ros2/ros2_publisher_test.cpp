// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_publisher.hpp"

#include <chrono>
#include <map>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/forked.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr char kPoseType[] = "geometry_msgs/msg/PoseStamped";
constexpr char kWrenchType[] = "geometry_msgs/msg/WrenchStamped";
constexpr char kTransformType[] = "tf2_msgs/msg/TFMessage";
constexpr char kStringType[] = "std_msgs/msg/String";

SiteScene two_boxes() {
  return {.name = "scene",
          .version = "0",
          .objects = {"a box", "lid"},
          .tool_radius = 0.01,
          .T_base_objects = {Pose::from_translation({0.3, 0.0, 0.05}),
                             Pose::from_translation({0.6, 0.1, 0.02})}};
}

/// The first box is turned by a quarter and pushed along base's x.
std::vector<LinkPrediction> a_push() {
  LinkPrediction box;
  box.pose = {0.4F, 0.05F, std::numbers::pi_v<float> / 2.0F};
  box.rendered_force = {6.0F, 0.0F, 0.0F};
  box.phase = MotionPhase::sliding;
  LinkPrediction lid;
  lid.pose = {0.6F, 0.1F, 0.0F};
  return {box, lid};
}

template <typename Message>
Message decoded(const char* type, const Bytes& bytes) {
  const Expected<RosMessage> message = decode_ros_message(
      {.name = "", .type = type, .encoding = "cdr", .schema_encoding = {}, .schema = {}}, bytes);
  EXPECT_TRUE(message) << message.error().to_string();
  return message ? std::get<Message>(*message) : Message{};
}

TEST(Ros2Publisher, PublishesBodiesForcesAndPhasesToAnotherProcess) {
  const DdsOptions options = loopback_options();
  const ForkedProcess site([&] {
    ForkedProcess::report_ready();
    const auto publisher = Ros2Publisher::create(
        {.dds = options, .base_frame = "base_link", .prefix = "/site", .rate = 100.0}, two_boxes());
    const std::vector<LinkPrediction> push = a_push();
    while (publisher) {
      (*publisher)->on_predictions(0.25, push);
      std::this_thread::sleep_for(1ms);
    }
  });
  const Ros2Qos qos{.is_reliable = true, .depth = 10};
  const std::vector<Ros2Topic> topics = {{"/site/predicted/a_box", kPoseType, qos},
                                         {"/site/predicted_force/a_box", kWrenchType, qos},
                                         {"/site/phase/a_box", kStringType, qos},
                                         {"/site/phase/lid", kStringType, qos},
                                         {"/tf", kTransformType, qos}};
  auto transport = open_dds(topics, {}, options);
  if (!transport) GTEST_SKIP() << "no DDS on this network: " << transport.error().to_string();
  std::map<std::size_t, Bytes> received;
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (received.size() < topics.size() && std::chrono::steady_clock::now() < end) {
    (*transport)->wait(20ms, [&](std::size_t topic, std::span<const std::uint8_t> message) {
      received[topic].assign(message.begin(), message.end());
    });
  }
  ASSERT_EQ(received.size(), topics.size());
  const auto pose = decoded<RosPose>(kPoseType, received[0]);
  EXPECT_EQ(pose.header.frame, "base_link");
  EXPECT_LT((pose.position - Eigen::Vector3d(0.4, 0.05, 0.05)).norm(), 1e-6);
  // Stamped by the time for which it is predicted.
  ASSERT_TRUE(pose.header.stamp);
  EXPECT_NEAR(pose.header.stamp->seconds(), read_clock(CLOCK_REALTIME) + 0.25, 0.2);
  // In the axes of the body, which is turned: RViz draws it there.
  const auto wrench = decoded<RosWrench>(kWrenchType, received[1]);
  EXPECT_EQ(wrench.header.frame, "a_box_predicted");
  EXPECT_LT((wrench.force - Eigen::Vector3d(0.0, -6.0, 0.0)).norm(), 1e-5);
  const auto text_of = [](const Bytes& bytes) {
    return std::string(bytes.begin() + 8, bytes.end() - 1);
  };
  EXPECT_EQ(text_of(received[2]).substr(0, 7), "sliding");
  EXPECT_EQ(text_of(received[3]).substr(0, 4), "free");
}

/// Counts what is published.
class CountingTransport final : public Ros2Transport {
 public:
  explicit CountingTransport(std::atomic<int>& count) : count_(count) {}
  void wait(std::chrono::milliseconds, const Receiver&) override {}
  bool publish(std::size_t, std::span<const std::uint8_t>) override {
    ++count_;
    return true;
  }
  [[nodiscard]] std::vector<std::string> take_notices() override { return {}; }

 private:
  std::atomic<int>& count_;
};

TEST(Ros2Publisher, CostsTheCycleNoAllocationAndKeepsItsRate) {
  std::atomic<int> published = 0;
  std::vector<Ros2Topic> opened;
  const auto publisher = Ros2Publisher::create(
      {.rate = 50.0}, two_boxes(),
      [&](const std::vector<Ros2Topic>&, const std::vector<Ros2Topic>& topics,
          const DdsOptions&) -> Expected<std::unique_ptr<Ros2Transport>> {
        opened = topics;
        return std::unique_ptr<Ros2Transport>(std::make_unique<CountingTransport>(published));
      });
  ASSERT_TRUE(publisher);
  ASSERT_EQ(opened.size(), 7U);
  EXPECT_EQ(opened[0].name, "/pcavr/predicted/a_box");
  EXPECT_EQ(opened[6].name, "/tf");
  const std::vector<LinkPrediction> push = a_push();
  const long before = heap_allocations_of_thread;
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begin < 300ms) {
    (*publisher)->on_predictions(0.1, push);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(heap_allocations_of_thread, before);
  std::this_thread::sleep_for(100ms);
  // Four messages for each of two bodies, every 20 ms.
  EXPECT_GE(published, 8 * 4);
  EXPECT_LE(published, 8 * 17);
}

}  // namespace
}  // namespace pcavr
