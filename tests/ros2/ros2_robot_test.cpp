// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_robot.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "marker/tag_rendering.hpp"
#include "ros2/planar_arm.hpp"
#include "support/ros_encoder.hpp"
#include "support/temporary_folder.hpp"
#include "teleoperation/ros2/ros2_intake.hpp"

namespace pcavr {
namespace {

using namespace std::chrono_literals;

using Bytes = std::vector<std::uint8_t>;
constexpr double kPeerClock = 1.7e9;  // [s] ahead of the local one
const Pose kStart(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())),
                  {0.3, 0.1, 0.2});

/// Both ends in this process.
struct FakeNetwork {
  std::mutex mutex;
  std::deque<std::pair<std::size_t, Bytes>> to_robot;
  std::vector<Bytes> from_robot;
  std::atomic<bool> fails = false;

  void send(std::size_t topic, Bytes message) {
    const std::lock_guard lock(mutex);
    to_robot.emplace_back(topic, std::move(message));
  }
  [[nodiscard]] std::size_t count() {
    const std::lock_guard lock(mutex);
    return from_robot.size();
  }
  /// Those sent up to now: the robot's thread may go on sending.
  [[nodiscard]] std::vector<Bytes> sent() {
    const std::lock_guard lock(mutex);
    return from_robot;
  }
  [[nodiscard]] Bytes last() {
    const std::lock_guard lock(mutex);
    return from_robot.empty() ? Bytes{} : from_robot.back();
  }
};

class FakeTransport final : public Ros2Transport {
 public:
  explicit FakeTransport(FakeNetwork& network) : network_(network) {}
  void wait(std::chrono::milliseconds, const Receiver& receive) override {
    std::this_thread::sleep_for(1ms);
    PCAVR_REQUIRE(!network_.fails, "made to fail");
    std::deque<std::pair<std::size_t, Bytes>> messages;
    {
      const std::lock_guard lock(network_.mutex);
      messages.swap(network_.to_robot);
    }
    for (const auto& [topic, message] : messages) receive(topic, message);
  }
  bool publish(std::size_t, std::span<const std::uint8_t> message) override {
    PCAVR_REQUIRE(!network_.fails, "made to fail");
    const std::lock_guard lock(network_.mutex);
    network_.from_robot.emplace_back(message.begin(), message.end());
    return true;
  }
  [[nodiscard]] std::vector<std::string> take_notices() override { return {}; }

 private:
  FakeNetwork& network_;
};

Ros2Setup small_setup() {
  Ros2Setup setup;
  setup.start_timeout = 0.2;
  setup.silence_timeout = 0.1;
  setup.tool = {"/tool", "geometry_msgs/msg/PoseStamped", {}};
  setup.tool_frame = "tool0";
  setup.wrench = Ros2Topic{"/wrench", "geometry_msgs/msg/WrenchStamped", {}};
  setup.transforms = Ros2Topic{"/tf", "tf2_msgs/msg/TFMessage", {}};
  setup.objects = {{"box", {"/box", "geometry_msgs/msg/PoseStamped", {}}, 0.002}};
  setup.command = Ros2Topic{"/command", "geometry_msgs/msg/PoseStamped", {}};
  return setup;
}
constexpr std::size_t kTool = 0, kWrench = 1, kTransforms = 2, kBox = 3;

Stamp peer_stamp(double t) { return Stamp::from_seconds(t + kPeerClock); }
double local_now() { return read_clock(CLOCK_BOOTTIME); }
Bytes tool_at(const Pose& pose, double t, std::string_view frame = "base_link") {
  return cdr::pose_stamped(peer_stamp(t), pose, frame);
}

class Ros2IntakeTest : public testing::Test {
 protected:
  std::vector<Ros2Sample> take() {
    std::vector<Ros2Sample> taken;
    for (Bytes bytes; samples_.pop(bytes);) {
      Ros2Sample& sample = taken.emplace_back();
      std::memcpy(&sample, bytes.data(), sizeof(sample));
    }
    return taken;
  }
  std::string take_notices() {
    std::string lines;
    for (Bytes bytes; notices_.pop(bytes);) lines += std::string(bytes.begin(), bytes.end()) + '\n';
    return lines;
  }

  Ros2Setup setup_ = small_setup();
  RecordQueue samples_{1U << 16U};
  RecordQueue notices_{1U << 16U};
  Ros2Notices notes_{notices_};
  Ros2Intake intake_{setup_, {4}, samples_, notes_};
};

TEST_F(Ros2IntakeTest, BringsSamplesToTheBaseFrameAndTheLocalClock) {
  intake_.on_message(kTool, tool_at(kStart, 10.0), 10.001);
  intake_.on_message(kWrench,
                     cdr::wrench_stamped(peer_stamp(10.002), {1, 0, 0}, {0, 0, 2}, "tool0"), 10.02);
  intake_.on_message(kBox, tool_at(kStart, 10.005), 10.4);
  const std::vector<Ros2Sample> samples = take();
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_NEAR(samples[0].t, 10.001, 1e-6);  // the fastest message is taken as without delay
  EXPECT_NEAR(samples[1].t, 10.003, 1e-6);
  EXPECT_NEAR(samples[2].t, 10.006, 1e-6);
  EXPECT_EQ(samples[0].values[0], 0.3);
  EXPECT_NEAR(samples[1].values[0], std::cos(0.5), 1e-12);  // in the tool's axes
  EXPECT_NEAR(samples[1].values[1], std::sin(0.5), 1e-12);
  EXPECT_NEAR(samples[1].values[5], 2.0, 1e-12);
  EXPECT_EQ(samples[2].object, 4U);
  EXPECT_EQ(samples[2].std[0], 0.002);
  EXPECT_EQ(take_notices(), "");
}

TEST_F(Ros2IntakeTest, UsesTransformsForOtherFrames) {
  intake_.on_message(kTool, tool_at(kStart, 10.0), 10.0);
  intake_.on_message(kBox, tool_at(Pose::from_translation({0, 0, 1}), 10.0, "camera"), 10.0);
  EXPECT_EQ(take().size(), 1U);
  EXPECT_NE(take_notices().find("/box: frame camera is not base_link, and no transforms connect"),
            std::string::npos);
  // 90 degrees about x, 1 m ahead: the camera's z is -y of the base.
  const Pose T_base_camera(
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX())),
      {1, 0, 0});
  intake_.on_message(
      kTransforms, cdr::tf_message(peer_stamp(10.0), {{"camera", T_base_camera}}, "base_link"), 10);
  intake_.on_message(kBox, tool_at(Pose::from_translation({0, 0, 1}), 10.1, "camera"), 10.1);
  const std::vector<Ros2Sample> samples = take();
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_NEAR(samples[0].values[0], 1.0, 1e-12);
  EXPECT_NEAR(samples[0].values[1], -1.0, 1e-12);
  EXPECT_NEAR(samples[0].values[2], 0.0, 1e-12);
  // A force at the camera turns about the tip.
  intake_.on_message(kWrench, cdr::wrench_stamped(peer_stamp(10.1), {1, 0, 0}, {0, 0, 0}, "camera"),
                     10.1);
  const std::vector<Ros2Sample> wrench = take();
  ASSERT_EQ(wrench.size(), 1U);
  const Eigen::Vector3d torque =
      (T_base_camera.translation() - kStart.translation()).cross(Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(wrench[0].values[4], torque.y(), 1e-12);
  EXPECT_NEAR(wrench[0].values[5], torque.z(), 1e-12);
}

TEST_F(Ros2IntakeTest, IgnoresWhatIsNotValidWithOneLineEach) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  intake_.on_message(kTool, tool_at(kStart, 10.0), 10.0);
  (void)take();
  const Pose far = Pose::from_translation({1e6, 0, 0});
  for (int i = 1; i < 50; ++i) {
    const double t = 10.0 + 0.01 * i;
    Bytes cut = tool_at(kStart, t);
    cut.resize(cut.size() - 1);
    intake_.on_message(kTool, cut, t);
    intake_.on_message(kTool, {}, t);
    intake_.on_message(kTool, tool_at(far, t), t);
    intake_.on_message(kWrench, cdr::wrench_stamped(peer_stamp(t), {nan, 0, 0}, {0, 0, 0}), t);
    intake_.on_message(kWrench, cdr::wrench_stamped(peer_stamp(t), {1e9, 0, 0}, {0, 0, 0}, ""), t);
    intake_.on_message(kWrench, cdr::wrench_stamped(peer_stamp(t), {1, 0, 0}, {0, 0, 0}, "up"), t);
  }
  EXPECT_EQ(take().size(), 0U);
  const std::string notices = take_notices();
  EXPECT_EQ(std::count(notices.begin(), notices.end(), '\n'), 6) << notices;
  // Stamps that do not ascend, and more of them than any robot sends.
  intake_.on_message(kTool, tool_at(kStart, 11.0), 11.0);
  intake_.on_message(kTool, tool_at(kStart, 10.9), 11.0);
  for (int i = 0; i < 1000; ++i) intake_.on_message(kTool, tool_at(kStart, 11 + 1e-6 * i), 11.0);
  EXPECT_LE(take().size(), 6U);
}

TEST_F(Ros2IntakeTest, FollowsAClockThatIsSetAndKnowsAnotherClock) {
  intake_.on_message(kTool, tool_at(kStart, 10.0), 10.0);
  intake_.on_message(kBox, tool_at(kStart, 10.0 - 86400.0), 10.03);
  EXPECT_NE(take_notices().find("/box: stamps are of another clock"), std::string::npos);
  intake_.on_message(kBox, tool_at(kStart, 10.1 - 86400.0), 10.13);
  intake_.on_message(kTool, tool_at(kStart, 10.1 - 3600.0), 10.1);  // an hour back
  EXPECT_NE(take_notices().find("/tool: stamps went back"), std::string::npos);
  intake_.on_message(kTool, tool_at(kStart, 10.2), 10.2);  // and forth
  const std::vector<Ros2Sample> samples = take();
  ASSERT_EQ(samples.size(), 5U);
  EXPECT_NEAR(samples[1].t, 10.03, 1e-5);
  EXPECT_NEAR(samples[2].t, 10.13, 1e-5);
  EXPECT_NEAR(samples[3].t, 10.1, 1e-5);
  EXPECT_NEAR(samples[4].t, 10.2, 1e-5);
}

// Messages with random faults: whatever is passed on is finite and ascends.
TEST_F(Ros2IntakeTest, PassesOnlyFiniteSamplesOfFaultyMessages) {
  Random random(1);
  const auto number = [&](std::size_t end) {
    return static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(end) - 1e-9));
  };
  std::size_t passed = 0;
  std::map<std::pair<Ros2Sample::Kind, std::uint64_t>, double> last;
  for (int i = 0; i < 20'000; ++i) {
    const double t = 10.0 + 0.001 * i;
    const std::size_t topic = number(4);
    Bytes message =
        topic == kWrench       ? cdr::wrench_stamped(peer_stamp(t), {1, 2, 3}, {0, 0, 0}, "tool0")
        : topic == kTransforms ? cdr::tf_message(peer_stamp(t), {{"camera", kStart}}, "base_link")
                               : tool_at(kStart, t, number(2) == 0 ? "base_link" : "camera");
    if (number(4) == 0) message.resize(number(message.size()));
    for (std::size_t faults = number(4); faults > 0 && !message.empty(); --faults) {
      message[number(message.size())] = static_cast<std::uint8_t>(number(256));
    }
    intake_.on_message(topic, message, t);
    for (const Ros2Sample& sample : take()) {
      ++passed;
      EXPECT_TRUE(std::isfinite(sample.t));
      for (const double value : sample.values) ASSERT_TRUE(std::isfinite(value));
      const auto [entry, is_new] = last.try_emplace({sample.kind, sample.object}, sample.t);
      if (!is_new) {
        ASSERT_GT(sample.t, entry->second);
        entry->second = sample.t;
      }
    }
    (void)take_notices();
  }
  EXPECT_GT(passed, 2000U);
}

class Ros2RobotTest : public testing::Test {
 protected:
  Expected<std::unique_ptr<RobotInterface>> connect() {
    TeleopInput world;
    world.objects.resize(1);
    world.objects[0].name = "box";
    return make_ros2_robot(
        setup_, world,
        [this](const std::vector<Ros2Topic>&, const std::vector<Ros2Topic>&,
               const DdsOptions&) -> Expected<std::unique_ptr<Ros2Transport>> {
          return std::unique_ptr<Ros2Transport>(std::make_unique<FakeTransport>(network_));
        });
  }
  /// A tool that stands at kStart, sampled at 100 Hz, while the site gives setpoints at `p_base`:
  /// until `is_done`, which is false if that takes longer than any loaded machine needs.
  template <typename Done>
  bool run_until(RobotInterface& robot, const Eigen::Vector3d& p_base, const Done& is_done,
                 bool is_tool_sent = true) {
    const auto end = std::chrono::steady_clock::now() + 60s;
    for (int i = 0; !is_done() && std::chrono::steady_clock::now() < end; ++i) {
      if (is_tool_sent && i % 10 == 0) network_.send(kTool, tool_at(kStart, local_now()));
      robot.set_command(p_base, Eigen::Quaterniond::Identity());
      robot.advance(local_now() - start_, samples_);
      for (const std::string& line : robot.take_notices()) notices_ += line + '\n';
      std::this_thread::sleep_for(1ms);
    }
    return is_done();
  }
  void run(RobotInterface& robot, std::chrono::milliseconds duration, const Eigen::Vector3d& p_base,
           bool is_tool_sent = true) {
    const auto end = std::chrono::steady_clock::now() + duration;
    run_until(
        robot, p_base, [&] { return std::chrono::steady_clock::now() >= end; }, is_tool_sent);
  }
  [[nodiscard]] auto has_notice(const char* text) const {
    return [this, text] { return notices_.find(text) != std::string::npos; };
  }

  FakeNetwork network_;
  Ros2Setup setup_ = small_setup();
  RobotSamples samples_;
  std::string notices_;
  double start_ = local_now();
};

TEST_F(Ros2RobotTest, NeedsThePoseOfTheTool) {
  const auto robot = connect();
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.error().to_string().find(
                "no geometry_msgs/msg/PoseStamped on /tool within 0.2 s in domain 0"),
            std::string::npos)
      << robot.error().to_string();
  setup_.objects[0].name = "cup";
  EXPECT_NE(connect().error().to_string().find("cup is not an object of the scene"),
            std::string::npos);
}

TEST_F(Ros2RobotTest, GoesOnWhenTheTransportWorksAgain) {
  network_.send(kTool, tool_at(kStart, local_now()));
  auto robot = connect();
  ASSERT_TRUE(robot) << robot.error().to_string();
  const Eigen::Vector3d near = kStart.translation() + Eigen::Vector3d(0.02, 0, 0);
  const auto has_published = [&] { return network_.count() > 0; };
  ASSERT_TRUE(run_until(**robot, near, has_published));
  network_.fails = true;
  ASSERT_TRUE(run_until(**robot, near, has_notice("messages of the robot: ")));
  ASSERT_TRUE(run_until(**robot, near, has_notice("made to fail")));
  network_.fails = false;
  const std::size_t before = network_.count();
  EXPECT_TRUE(run_until(**robot, near, [&] { return network_.count() > before; }));
}

TEST_F(Ros2RobotTest, MeasuresAndPublishesSetpointsNearTheTool) {
  network_.send(kTool, tool_at(kStart, local_now()));
  auto robot = connect();
  ASSERT_TRUE(robot) << robot.error().to_string();
  EXPECT_TRUE((*robot)->follows_commands());
  EXPECT_LT(((*robot)->p_base_start() - kStart.translation()).norm(), 1e-12);
  const Eigen::Vector3d near = kStart.translation() + Eigen::Vector3d(0.02, 0, 0);
  const double begin = local_now();
  ASSERT_TRUE(
      run_until(**robot, near, [&] { return samples_.tool.size() > 20 && network_.count() > 20; }));
  EXPECT_LT((samples_.tool.back().p_base_tip - kStart.translation()).norm(), 1e-12);
  EXPECT_GT(samples_.tool.back().t, begin - start_);
  EXPECT_LE(samples_.tool.back().t, local_now() - start_);
  for (std::size_t i = 1; i < samples_.tool.size(); ++i) {
    EXPECT_GT(samples_.tool[i].t, samples_.tool[i - 1].t);
  }
  const BagTopic topic{"/command", "geometry_msgs/msg/PoseStamped", "cdr", {}, {}};
  const auto message = decode_ros_message(topic, network_.last());
  ASSERT_TRUE(message);
  const auto& pose = std::get<RosPose>(*message);
  EXPECT_EQ(pose.header.frame, "base_link");
  EXPECT_LT((pose.position - near).norm(), 1e-12);
  EXPECT_LT(pose.orientation->angularDistance(kStart.rotation()), 1e-9);  // kept

  // Far from the tool nothing is commanded.
  const Eigen::Vector3d far = near + Eigen::Vector3d(0, 0.2, 0);
  ASSERT_TRUE(
      run_until(**robot, far,
                has_notice("/command: the setpoint is more than 0.05 m from the measured tip")));
  std::size_t published = network_.count();
  run(**robot, 100ms, far);
  EXPECT_EQ(network_.count(), published);

  // Nor while the tool is silent.
  notices_.clear();
  ASSERT_TRUE(run_until(**robot, near, has_notice("/tool: no message any more"), false));
  run(**robot, 100ms, near, false);  // a setpoint that was on its way
  published = network_.count();
  run(**robot, 100ms, near, false);
  EXPECT_EQ(network_.count(), published);

  // Nor by a site that stands still.
  ASSERT_TRUE(run_until(**robot, near, [&] { return network_.count() > published; }));
  std::this_thread::sleep_for(100ms);
  published = network_.count();
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(network_.count(), published);
}

Bytes bytes_of_text(const std::string& text) { return {text.begin(), text.end()}; }

// Tags of the table and of the box in one image: the box's pose in the base frame.
/// Positions of the only point of a JointTrajectory with two joints.
std::array<double, 2> positions_of(const Bytes& trajectory) {
  std::array<double, 2> positions{};
  constexpr std::size_t kAfter = 20;  // three empty sequences and the time
  std::memcpy(positions.data(), trajectory.data() + trajectory.size() - kAfter - sizeof(positions),
              sizeof(positions));
  return positions;
}

TEST_F(Ros2RobotTest, CommandsJointsToThePoseThatIsCommanded) {
  const TemporaryFolder folder;
  setup_ = planar_arm_setup(folder.path());
  setup_.command = Ros2Topic{"/trajectory", "trajectory_msgs/msg/JointTrajectory", {}};
  setup_.is_command_of_joints = true;
  setup_.follows_orientation = true;
  const double shoulder = 0.3, elbow = 0.5, shoulder_target = 0.35, elbow_target = 0.52;
  const auto send = [&] {
    RosEncoder encoder(RosEncoder::Format::cdr);
    encoder.header(peer_stamp(local_now()), "").number(std::uint32_t{3});
    for (const char* const name : {"grip", "elbow", "shoulder"}) encoder.text(name);
    const std::string text =
        encoder.doubles({0.01, elbow, shoulder}).doubles({}).doubles({}).bytes();
    network_.send(kTool, Bytes(text.begin(), text.end()));
  };
  send();
  auto robot = connect();
  ASSERT_TRUE(robot) << robot.error().to_string();
  const double yaw = shoulder_target + elbow_target;
  const Eigen::Vector3d target(0.4 * std::cos(shoulder_target) + 0.3 * std::cos(yaw),
                               0.4 * std::sin(shoulder_target) + 0.3 * std::sin(yaw), 0.0);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  for (int i = 0; i < 500; ++i) {
    if (i % 10 == 0) send();
    (*robot)->set_command(target, turned);
    (*robot)->advance(local_now() - start_, samples_);
    std::this_thread::sleep_for(1ms);
  }
  ASSERT_GT(network_.count(), 50U);
  const std::vector<Bytes> sent = network_.sent();
  const std::array<double, 2> first = positions_of(sent.front());
  const std::array<double, 2> last = positions_of(network_.last());
  // The commands go from the measured joints, in the order of the chain, no faster than the tool
  // may turn.
  EXPECT_NEAR(first[0], shoulder, 0.01);
  EXPECT_NEAR(first[1], elbow, 0.01);
  EXPECT_NEAR(last[0], shoulder_target, 1e-3);
  EXPECT_NEAR(last[1], elbow_target, 1e-3);
  for (std::size_t i = 1; i < sent.size(); ++i) {
    const auto before = positions_of(sent[i - 1]);
    const auto after = positions_of(sent[i]);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      // [rad] in a cycle of 2 ms at the joint's 1 rad/s.
      EXPECT_LE(std::abs(after[joint] - before[joint]), 0.002 + 1e-9);
    }
  }
}

TEST_F(Ros2RobotTest, TurnsTheToolNoFasterThanItMay) {
  setup_.follows_orientation = true;
  network_.send(kTool, tool_at(kStart, local_now()));
  auto robot = connect();
  ASSERT_TRUE(robot) << robot.error().to_string();
  run(**robot, 200ms, kStart.translation());
  ASSERT_GT(network_.count(), 20U);
  const BagTopic topic{"/command", "geometry_msgs/msg/PoseStamped", "cdr", {}, {}};
  Eigen::Quaterniond before = kStart.rotation();
  for (const Bytes& bytes : network_.sent()) {
    const auto message = decode_ros_message(topic, bytes);
    ASSERT_TRUE(message);
    const Eigen::Quaterniond now = *std::get<RosPose>(*message).orientation;
    EXPECT_NEAR(before.angularDistance(now), 0.001, 1e-6);  // 0.5 rad/s at 500 Hz
    before = now;
  }
}

TEST_F(Ros2RobotTest, FindsObjectsByTheirTagsInImages) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "tags.yaml") << R"(
format: pcavr-recording/1
markers:
  - {family: tag36h11, id: 0, size: 0.12, role: base, pose: {t: [0, 0, 0], q: [0, 0, 0, 1]}}
  - {family: tag36h11, id: 5, size: 0.08, role: object, object: box, pose: {t: [0, 0, 0.05], q: [0, 0, 0, 1]}}
objects:
  - {name: box}
)";
  setup_.camera = Ros2Camera{{"/image", "sensor_msgs/msg/Image", {}},
                             {"/camera_info", "sensor_msgs/msg/CameraInfo", {}},
                             "",
                             folder.path() / "tags.yaml"};
  constexpr std::size_t kImage = 4, kInfo = 5;
  const CameraModel camera = test::a_camera();
  const Pose T_camera_base = test::facing({-0.1, 0, 0.7}, 0.5, 0.3, 0.2);
  const Pose T_base_box = Pose::from_translation({0.2, 0.05, 0.0});
  const Pose T_box_marker = Pose::from_translation({0, 0, 0.05});
  const GrayImage image =
      test::render_tags({{{"tag36h11", 0}, 0.12, T_camera_base},
                         {{"tag36h11", 5}, 0.08, T_camera_base * T_base_box * T_box_marker}},
                        camera);
  const std::string pixels(image.pixels().begin(), image.pixels().end());
  const auto width = static_cast<std::uint32_t>(camera.width);
  const auto height = static_cast<std::uint32_t>(camera.height);
  network_.send(kTool, tool_at(kStart, local_now()));
  auto robot = connect();
  ASSERT_TRUE(robot) << robot.error().to_string();
  const auto encoder = [] { return RosEncoder(RosEncoder::Format::cdr); };
  const auto send_image = [&] {
    network_.send(kImage, bytes_of_text(encoder()
                                            .image(peer_stamp(local_now()), "camera", width, height,
                                                   "mono8", pixels)
                                            .bytes()));
  };
  (*robot)->advance(local_now() - start_, samples_);
  send_image();
  EXPECT_TRUE(run_until(**robot, kStart.translation(), has_notice("/image: no camera info yet")))
      << notices_;
  network_.send(kInfo, bytes_of_text(encoder()
                                         .camera_info(peer_stamp(local_now()), "camera", width,
                                                      height, camera.fx, camera.cx, camera.cy)
                                         .bytes()));
  send_image();
  ASSERT_TRUE(run_until(**robot, kStart.translation(), [&] { return !samples_.tracked.empty(); }))
      << notices_;
  ASSERT_EQ(samples_.tracked.size(), 1U);
  EXPECT_EQ(samples_.tracked[0].object, 0U);
  const TrackedPose& found = samples_.tracked[0].pose;
  // The marker tests' tolerance at this distance: 1 mm.
  EXPECT_LT((found.T_base_object.translation() - T_base_box.translation()).norm(), 0.002);
  EXPECT_GT(found.position_std, 1e-6);
  EXPECT_LT(found.position_std, 0.01);
  EXPECT_LT(std::abs(found.t - (local_now() - start_)), 5.0);
  // The operator sees the same image.
  ASSERT_NE((*robot)->pictures(), nullptr);
  const auto picture = (*robot)->pictures()->newest(local_now() - start_);
  ASSERT_TRUE(picture && *picture);
  EXPECT_LT(std::abs((*picture)->t - found.t), 1e-3);
  ASSERT_EQ((*picture)->image.width(), camera.width);
  ASSERT_EQ((*picture)->image.height(), camera.height);
  EXPECT_FALSE(*(*robot)->pictures()->newest(local_now() - start_)) << "it was had already";
}

TEST_F(Ros2RobotTest, NeedsTagsOfTheScene) {
  const TemporaryFolder folder;
  setup_.camera = Ros2Camera{};
  setup_.camera->tags = folder.path() / "none.yaml";
  EXPECT_NE(connect().error().to_string().find("none.yaml"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
