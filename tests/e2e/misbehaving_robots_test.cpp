// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What a robot does wrong ends no site: a plugin that is late, stands still, throws or gives
// numbers that are not valid, and peers on ROS 2 that send anything.
#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/random.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/command.hpp"
#include "support/forked.hpp"
#include "support/running_command.hpp"
#include "support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

class MisbehavingRobots : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const std::vector<std::string> simulate{"simulate", "push", "--no-images", "--seed", "3"};
    std::vector<std::string> arguments = simulate;
    arguments.insert(arguments.end(), {"-o", path("recording")});
    ASSERT_EQ(run_pcavr(arguments).exit_code, 0);
    ASSERT_EQ(run_pcavr({"build", path("recording"), "-o", path("scene")}).exit_code, 0);
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }
  static fs::path folder() { return folder_->path(); }

  /// A robot's site with these options, and the operator's that moves as in the recording.
  struct Pair {
    std::string name;
    std::unique_ptr<RunningCommand> robot, person;
  };
  static Pair start(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"robot-site", path("scene"), "--port", "0", "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    Pair pair{name, std::make_unique<RunningCommand>(arguments, folder(), name), nullptr};
    const bool is_there = pair.robot->has_printed("\n");
    EXPECT_TRUE(is_there) << pair.robot->errors();
    if (!is_there) return pair;
    const std::string line = pair.robot->output();
    const json printed = json::parse(line.substr(0, line.find('\n')), nullptr, false);
    EXPECT_TRUE(printed.is_object()) << line;
    if (!printed.is_object()) return pair;
    const int port = printed.value("port", 0);
    const std::vector<std::string> person{"operator-site",   path("scene"), "--trace",
                                          path("recording"), "--port",      std::to_string(port),
                                          "--json"};
    pair.person = std::make_unique<RunningCommand>(person, folder(), name + "_person");
    return pair;
  }
  /// Both end well, the operator's with its motion; the robot's result.
  static json end_of(Pair& pair) {
    EXPECT_EQ(pair.person->wait(), 0) << pair.name << ": " << pair.person->errors();
    pair.robot->signal(SIGINT);
    EXPECT_EQ(pair.robot->wait(), 0) << pair.name << ": " << pair.robot->errors();
    const std::string output = pair.robot->output();
    return json::parse(output.substr(output.find('\n') + 1), nullptr, false);
  }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(MisbehavingRobots, OfPluginsAreHeldAndSaidAndEndNothing) {
  struct Case {
    const char* fault;
    const char* said;
  };
  const std::vector<Case> cases = {
      {"throws", "the robot's plugin throws: thrown for a while"},
      {"invalid", "a sample of the robot's plugin is not valid, and is ignored"},
      {"late", "the robot's plugin takes more than 0.5 ms"},
      {"stops", "the robot's plugin takes more than 0.5 ms"}};
  std::vector<Pair> pairs;
  for (const Case& one : cases) {
    pairs.push_back(
        start(one.fault, {"--plugin", std::string(PCAVR_MISBEHAVING_PLUGIN) + "," + one.fault}));
  }
  for (std::size_t i = 0; i < cases.size(); ++i) {
    ASSERT_TRUE(pairs[i].person) << cases[i].fault;
    const json result = end_of(pairs[i]);
    ASSERT_TRUE(result.is_object()) << cases[i].fault << pairs[i].robot->output();
    EXPECT_GT(result["commands"].get<int>(), 1000) << cases[i].fault;
    EXPECT_NE(pairs[i].robot->errors().find(cases[i].said), std::string::npos)
        << cases[i].fault << ": " << pairs[i].robot->errors();
  }
}

/// A sound message with random bytes changed, cut or added, or anything at all.
Bytes corrupted(Bytes message, pcavr::Random& random) {
  const std::size_t kind = random.below(4);
  if (kind == 0) message.resize(random.below(static_cast<std::uint32_t>(message.size())));
  if (kind == 1) message.resize(random.below(100'000));
  const std::size_t faults = kind == 2 ? message.size() : random.below(8);
  for (std::size_t i = 0; i < faults && !message.empty(); ++i) {
    message[random.below(static_cast<std::uint32_t>(message.size()))] =
        static_cast<std::uint8_t>(random.below(256));
  }
  return message;
}

TEST_F(MisbehavingRobots, OnRos2SendAnythingBesideWhatIsSound) {
  const pcavr::DdsOptions dds = pcavr::loopback_options();
  const pcavr::Ros2Topic pose{"/tool_pose", "geometry_msgs/msg/PoseStamped", {.depth = 10}};
  const pcavr::Ros2Topic wrench{"/wrench", "geometry_msgs/msg/WrenchStamped", {.depth = 10}};
  const pcavr::Ros2Topic box{"/box", pose.type, {.depth = 10}};
  const auto stamp_now = [] {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return pcavr::Stamp{now.tv_sec * 1'000'000'000 + now.tv_nsec};
  };
  const pcavr::Pose T_base_tool = pcavr::Pose::from_translation({0.2, 0.0, 0.1});
  const ForkedProcess sound([&] {
    auto topics = pcavr::open_dds({}, {pose, wrench}, dds);
    ForkedProcess::report_ready();
    while (topics) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      const pcavr::Stamp stamp = stamp_now();
      (void)(*topics)->publish(0, pcavr::cdr::pose_stamped(stamp, T_base_tool, "base_link"));
      (void)(*topics)->publish(1, pcavr::cdr::wrench_stamped(stamp, {0, 0, 0}, {0, 0, 0}, "tool0"));
    }
  });
  const ForkedProcess hostile([&] {
    auto topics = pcavr::open_dds({}, {pose, wrench, box}, dds);
    ForkedProcess::report_ready();
    pcavr::Random random(5);
    while (topics) {
      std::this_thread::sleep_for(std::chrono::microseconds(500));
      const pcavr::Stamp stamp{stamp_now().nanoseconds +
                               (static_cast<std::int64_t>(random.below(200)) - 100) *
                                   1'000'000'000};
      const std::size_t topic = random.below(3);
      const Bytes message = topic == 1
                                ? pcavr::cdr::wrench_stamped(stamp, {1, 2, 3}, {0, 0, 0}, "tool0")
                                : pcavr::cdr::pose_stamped(stamp, T_base_tool, "base_link");
      (void)(*topics)->publish(topic, corrupted(message, random));
    }
  });
  std::ofstream(folder() / "ros2.yaml") << "format: pcavr-ros2/1\ndomain: " << dds.domain << R"(
network: {interface: 127.0.0.1, peers: [127.0.0.1], multicast: false}
tool: {topic: /tool_pose, frame: tool0}
wrench: {topic: /wrench}
objects: {box_1: {topic: /box, position_std: 0.002}}
)";
  Pair pair = start("ros2", {"--ros2", path("ros2.yaml")});
  ASSERT_TRUE(pair.person);
  const json result = end_of(pair);
  ASSERT_TRUE(result.is_object()) << pair.robot->output();
  EXPECT_NE(pair.robot->errors().find("ignored"), std::string::npos) << pair.robot->errors();
}

}  // namespace
