// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/link_transport.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/command.hpp"
#include "support/forked.hpp"
#include "support/running_command.hpp"
#include "support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using std::chrono::milliseconds;

/// Content of corrections.csv: stamps of a clock differ from those of a recording by its rounding.
std::string without_last_digits(const std::string& corrections) {
  std::string text;
  std::istringstream lines(corrections);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comma = line.find(',');
    text += std::isdigit(static_cast<unsigned char>(line[0])) != 0
                ? std::to_string(std::lround(1e3 * std::stod(line))) + line.substr(comma)
                : line;
    text += '\n';
  }
  return text;
}

/// Both programs on loopback with keys, over a recording of two pushes.
class TwoSites : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    ASSERT_EQ(run_pcavr({"simulate", "push", "--no-images", "--seed", "3", "-o", path("recording")})
                  .exit_code,
              0);
    ASSERT_EQ(run_pcavr({"build", path("recording"), "-o", path("scene")}).exit_code, 0);
    for (const char* const name : {"robot", "alice", "mallory"}) {
      ASSERT_EQ(run_pcavr({"keygen", name, "-o", path("keys")}).exit_code, 0);
    }
    fs::create_directory(path("authorized"));
    fs::copy_file(path("keys/alice.pub"), path("authorized/alice.pub"));
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }
  static std::vector<std::string> robot_arguments() {
    return {"robot-site",      path("scene"),
            "--recording",     path("recording"),
            "--port",          "0",
            "--key",           path("keys/robot.key"),
            "--json",          "--authorized",
            path("authorized")};
  }
  static std::vector<std::string> operator_arguments(int port, const std::string& name,
                                                     const std::string& robot = "robot") {
    return {"operator-site", path("scene"),
            "--trace",       path("recording"),
            "--port",        std::to_string(port),
            "--key",         path("keys/" + name + ".key"),
            "--robot-key",   path("keys/" + robot + ".pub"),
            "--json"};
  }
  /// Waits for the line that a robot's site prints once it accepts connections.
  static int port_of(const RunningCommand& robot) {
    for (int i = 0; i < 600; ++i) {
      const std::string output = robot.output();
      if (const std::size_t end = output.find('\n'); end != std::string::npos) {
        const json line = json::parse(output.substr(0, end), nullptr, false);
        return line.is_object() ? line.value("port", 0) : 0;
      }
      std::this_thread::sleep_for(milliseconds(50));
    }
    return 0;
  }
  static json result_of(const RunningCommand& robot) {
    const std::string output = robot.output();
    return json::parse(output.substr(output.find('\n') + 1), nullptr, false);
  }
  /// The findings of `evaluate` for a run of the recording.
  static json evaluated(const std::string& run) {
    const CommandOutcome outcome =
        run_pcavr({"evaluate", path(run), "--truth", path("recording/truth"), "-o",
                   path(run + "_report"), "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
    return json::parse(text_of(folder() / (run + "_report") / "report.json"), nullptr, false);
  }
  static fs::path folder() { return folder_->path(); }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

void expect_one_line(const CommandOutcome& outcome, const std::string& about) {
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find(about), std::string::npos) << outcome.standard_error;
}

/// What a subscriber to one body's predictions of one site has received.
struct ReceivedPredictions {
  std::vector<double> t;  ///< [s] stamps of the poses
  std::vector<Eigen::Vector3d> positions_base;
  std::size_t wrenches = 0;
  double max_force = 0.0;  ///< [N]
  std::set<std::string> phases;
};

const std::vector<std::string> kPublishingSites{"robot", "operator"};

/// Asks a site for predictions under its name.
std::string publication(const std::string& site, const pcavr::DdsOptions& dds) {
  return "format: pcavr-ros2/1\ndomain: " + std::to_string(dds.domain) +
         "\nnetwork: {interface: 127.0.0.1, peers: [127.0.0.1], multicast: false}\n"
         "publish: {prefix: /" +
         site + ", rate: 50}\n";
}

/// Writes each message to a file: topic, stamp [s], and its three numbers or its text. Returns
/// where DDS can not be opened, else never.
void record_predictions(const fs::path& file, const pcavr::DdsOptions& dds) {
  std::vector<pcavr::Ros2Topic> topics;
  const pcavr::Ros2Qos qos{.is_reliable = true, .depth = 200};
  for (const std::string& site : kPublishingSites) {
    for (const std::string body : {"box_1", "box_2"}) {
      topics.push_back({"/" + site + "/predicted/" + body, "geometry_msgs/msg/PoseStamped", qos});
      topics.push_back(
          {"/" + site + "/predicted_force/" + body, "geometry_msgs/msg/WrenchStamped", qos});
      topics.push_back({"/" + site + "/phase/" + body, "std_msgs/msg/String", qos});
    }
  }
  const auto transport = pcavr::open_dds(topics, {}, dds);
  if (!transport) {
    std::cerr << transport.error().to_string() << std::endl;
    return;  // which is not ready
  }
  std::ofstream received(file);
  ForkedProcess::report_ready();
  for (;;) {
    (*transport)->wait(milliseconds(20), [&](std::size_t i, std::span<const std::uint8_t> bytes) {
      const pcavr::BagTopic type{topics[i].name, topics[i].type, "cdr", {}, {}};
      if (type.type == "std_msgs/msg/String") {
        pcavr::ByteReader text(bytes.subspan(4));  // the CDR header
        const auto size = text.integer<std::uint32_t>();
        const auto letters = text.take(size - 1);
        received << type.name << ' ' << std::string(letters.begin(), letters.end()) << std::endl;
        return;
      }
      const auto message = pcavr::decode_ros_message(type, bytes);
      if (!message) return;
      const auto* pose = std::get_if<pcavr::RosPose>(&*message);
      const auto* wrench = std::get_if<pcavr::RosWrench>(&*message);
      const pcavr::RosHeader& header = pose != nullptr ? pose->header : wrench->header;
      const Eigen::Vector3d numbers = pose != nullptr ? pose->position : wrench->force;
      received << type.name << ' ' << std::fixed << std::setprecision(6)
               << header.stamp.value_or(pcavr::Stamp{}).seconds() << ' ' << numbers.transpose()
               << std::endl;
    });
  }
}

std::map<std::string, ReceivedPredictions> read_predictions(const fs::path& file) {
  std::map<std::string, ReceivedPredictions> received;  // by "/SITE/BODY"
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string topic;
    fields >> topic;
    const std::size_t kind = topic.find('/', 1);
    const std::size_t body = topic.rfind('/');
    ReceivedPredictions& of = received[topic.substr(0, kind) + topic.substr(body)];
    if (topic.find("/phase/") != std::string::npos) {
      std::string phase;
      fields >> phase;
      of.phases.insert(phase);
      continue;
    }
    double t = 0.0;
    Eigen::Vector3d numbers;
    if (!(fields >> t >> numbers.x() >> numbers.y() >> numbers.z())) continue;
    if (topic.find("/predicted_force/") != std::string::npos) {
      ++of.wrenches;
      of.max_force = std::max(of.max_force, numbers.norm());
    } else {
      of.t.push_back(t);
      of.positions_base.push_back(numbers);
    }
  }
  return received;
}

/// Both sites have published, at their rate, how both boxes were pushed.
void expect_predictions(const fs::path& file) {
  const auto received = read_predictions(file);
  ASSERT_EQ(received.size(), 4U);
  for (const auto& [name, of] : received) {
    ASSERT_GT(of.t.size(), 50U) << name;
    const double rate = static_cast<double>(of.t.size() - 1) / (of.t.back() - of.t.front());
    EXPECT_GT(rate, 10.0) << name;  // 50 on a machine that is not loaded
    EXPECT_LT(rate, 51.0) << name;
    EXPECT_NEAR(static_cast<double>(of.wrenches), static_cast<double>(of.t.size()), 3.0) << name;
    EXPECT_GT(of.max_force, 0.5) << name;
    EXPECT_LT(of.max_force, 100.0) << name;
    EXPECT_GT((of.positions_base.back() - of.positions_base.front()).norm(), 0.02) << name;
    EXPECT_TRUE(of.phases.count("free") == 1 && of.phases.count("sliding") == 1) << name;
    for (const std::string& phase : of.phases) {
      EXPECT_TRUE(phase == "free" || phase == "static" || phase == "critical" || phase == "sliding")
          << phase;
    }
  }
  for (const std::string body : {"/box_1", "/box_2"}) {
    const auto& at_robot = received.at("/robot" + body).positions_base;
    const auto& at_operator = received.at("/operator" + body).positions_base;
    EXPECT_LT((at_robot.back() - at_operator.back()).norm(), 0.002) << body;
  }
}

// A recording sent through both programs gives each correction to the operator's site once. A ROS 2
// subscriber sees what both predict.
TEST_F(TwoSites, CorrectTheOperatorsWorldOverADelayedLink) {
  const pcavr::DdsOptions dds = pcavr::loopback_options();
  ForkedProcess subscriber([&] { record_predictions(folder() / "predictions.txt", dds); });
  for (const std::string& site : kPublishingSites) {
    std::ofstream(folder() / (site + "_publish.yaml")) << publication(site, dds);
  }
  std::vector<std::string> robot_site = robot_arguments();
  robot_site.insert(robot_site.end(), {"--publish", path("robot_publish.yaml")});
  RunningCommand robot(robot_site, folder(), "robot");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  std::vector<std::string> arguments = operator_arguments(port, "alice");
  for (const char* const more :
       {"--forward-delay", "0.2", "--backward-delay", "0.2", "--loss", "0.1", "--duplicate", "1"}) {
    arguments.emplace_back(more);
  }
  arguments.insert(arguments.end(), {"--publish", path("operator_publish.yaml")});
  const CommandOutcome outcome = run_pcavr(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  ASSERT_EQ(robot.wait(), 0) << robot.errors();
  const json at_operator = json::parse(outcome.standard_output);
  const json at_robot = result_of(robot);
  EXPECT_GE(at_robot["corrections"].size(), 5U);
  EXPECT_GE(at_operator["corrections"].get<int>(), 5);
  EXPECT_LE(at_operator["corrections"].get<std::size_t>(), at_robot["corrections"].size());
  // Each arrives twice, and is applied once.
  EXPECT_GE(at_operator["repeated_corrections"].get<int>(), at_operator["corrections"].get<int>());
  EXPECT_EQ(at_operator["invalid_messages"], 0);
  EXPECT_EQ(at_robot["invalid_messages"], 0);
  EXPECT_GT(at_operator["lead_s"].get<double>(), 0.2);
  EXPECT_NEAR(at_operator["round_trip_s"].get<double>(), 0.4, 0.05);
  EXPECT_GT(at_operator["cycle_p50_s"].get<double>(), 0.0);
  EXPECT_LE(at_operator["cycle_p50_s"].get<double>(), at_operator["cycle_p999_s"].get<double>());
  subscriber.kill(SIGKILL);  // each line of it is flushed
  expect_predictions(folder() / "predictions.txt");
}

// One code path: a recording that passes through both programs in real time gives the corrections
// of a replay with the same delays. The margins are those of a loaded machine.
TEST_F(TwoSites, SendTheCorrectionsOfAReplay) {
  std::ofstream(folder() / "loaded.yaml")
      << R"(operator_site: {lead_margin: 0.05, correction_margin: 0.15, timeout: 2}
robot_site.link: {timeout: 2, max_age: 1}
)";
  const std::vector<std::string> config{"--config", path("loaded.yaml")};
  std::vector<std::string> robot_site = robot_arguments();
  robot_site.insert(robot_site.end(), config.begin(), config.end());
  robot_site.insert(robot_site.end(), {"--log", path("robot.mcap")});
  RunningCommand robot(robot_site, folder(), "robot_replayed");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  std::vector<std::string> arguments = operator_arguments(port, "alice");
  arguments.insert(arguments.end(), {"--forward-delay", "0.2", "--backward-delay", "0.2"});
  arguments.insert(arguments.end(), config.begin(), config.end());
  const CommandOutcome outcome = run_pcavr(arguments);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  ASSERT_EQ(robot.wait(), 0) << robot.errors();
  const json at_operator = json::parse(outcome.standard_output);
  const json live = result_of(robot)["corrections"];
  const auto lead = at_operator["lead_s"].get<double>();
  const double back = at_operator["correction_delay_s"].get<double>() - lead;
  ASSERT_EQ(
      run_pcavr({"replay", path("recording"), "--scene", path("scene"), "-o", path("run"),
                 "--forward-delay", std::to_string(lead), "--backward-delay", std::to_string(back)})
          .exit_code,
      0);
  std::ifstream replayed(folder() / "run/corrections.csv");
  std::string line;
  std::getline(replayed, line);  // the header
  std::size_t rows = 0;
  for (; std::getline(replayed, line); ++rows) {
    ASSERT_LT(rows, live.size()) << line;
    const json& sent = live[rows];
    EXPECT_NEAR(sent["t"].get<double>(), std::stod(line), 0.005) << line;
    const std::string object = "box_" + std::to_string(sent["object"].get<int>() + 1);
    const std::string rest = "," + object + "," + sent["case"].get<std::string>() + "," +
                             sent["what"].get<std::string>() + ",";
    EXPECT_NE(line.find(rest), std::string::npos) << line << " live: " << rest;
  }
  EXPECT_EQ(rows, live.size());
  EXPECT_GE(rows, 8U);
  // The black box is a run as it was: its corrections are the live ones, and so are its errors.
  ASSERT_EQ(
      run_pcavr({"replay", path("robot.mcap"), "--scene", path("scene"), "-o", path("logged_run")})
          .exit_code,
      0);
  EXPECT_EQ(without_last_digits(text_of(folder() / "logged_run/corrections.csv")),
            without_last_digits(text_of(folder() / "run/corrections.csv")));
  const json logged = evaluated("logged_run");
  const json replay = evaluated("run");
  for (const char* const key :
       {"predicted.touched.translation.median_m", "predicted.touched.translation.p95_m"}) {
    EXPECT_NEAR(logged[key].get<double>(), replay[key].get<double>(), 1e-4) << key;
  }
  for (const char* const key : {"nodes.t1.measured_s", "nodes.t5.measured_s",
                                "nodes.t1.predicted_s", "nodes.t5.predicted_s"}) {
    EXPECT_NEAR(logged[key].get<double>(), replay[key].get<double>(), 0.005) << key;
  }
}

TEST_F(TwoSites, LeaveLogsThatAreRunsOnlyOfTheirOwnScene) {
  std::ofstream(folder() / "cut.mcap") << "\x89MCAP0\r\n";
  expect_one_line(
      run_pcavr({"replay", path("cut.mcap"), "--scene", path("scene"), "-o", path("of_nothing")}),
      "no black box");
  expect_one_line(run_pcavr({"replay", path("cut.mcap"), "--scene", path("scene"), "-o",
                             path("of_nothing"), "--tracked", path("scene")}),
                  "--tracked is for recordings");
}

// A robot on ROS 2 topics, here one that reaches each setpoint at once, moves as the operator does.
TEST_F(TwoSites, MoveARobotOnRos2Topics) {
  const pcavr::DdsOptions dds = pcavr::loopback_options();
  const pcavr::Ros2Topic pose{"/tool_pose", "geometry_msgs/msg/PoseStamped", {.depth = 10}};
  const pcavr::Ros2Topic command{"/target", pose.type, {.is_reliable = true, .depth = 1}};
  const pcavr::Ros2Topic wrench{"/wrench", "geometry_msgs/msg/WrenchStamped", {.depth = 10}};
  const ForkedProcess peer([&] {
    auto topics = pcavr::open_dds({command}, {pose, wrench}, dds);
    ForkedProcess::report_ready();
    pcavr::Pose T_base_tool = pcavr::Pose::from_translation({0.2, 0.0, 0.1});
    std::ofstream received(folder() / "setpoints.txt");
    const pcavr::BagTopic type{command.name, command.type, "cdr", {}, {}};
    while (topics) {
      (*topics)->wait(milliseconds(2), [&](std::size_t, std::span<const std::uint8_t> bytes) {
        const auto message = pcavr::decode_ros_message(type, bytes);
        if (!message) return;
        const auto& setpoint = std::get<pcavr::RosPose>(*message);
        T_base_tool = pcavr::Pose::from_translation(setpoint.position);
        received << setpoint.header.stamp.value_or(pcavr::Stamp{}).nanoseconds << ' '
                 << setpoint.position.transpose() << std::endl;
      });
      timespec now{};
      ::clock_gettime(CLOCK_REALTIME, &now);
      const pcavr::Stamp stamp{now.tv_sec * 1'000'000'000 + now.tv_nsec};
      (void)(*topics)->publish(0, pcavr::cdr::pose_stamped(stamp, T_base_tool, "base_link"));
      (void)(*topics)->publish(1, pcavr::cdr::wrench_stamped(stamp, {0, 0, 0}, {0, 0, 0}, "tool0"));
    }
  });
  std::ofstream(folder() / "ros2.yaml") << "format: pcavr-ros2/1\ndomain: " << dds.domain << R"(
network: {interface: 127.0.0.1, peers: [127.0.0.1], multicast: false}
tool: {topic: /tool_pose, frame: tool0}
wrench: {topic: /wrench}
command: {topic: /target}
)";
  std::vector<std::string> arguments = robot_arguments();
  arguments[2] = "--ros2";
  arguments[3] = path("ros2.yaml");
  RunningCommand robot(arguments, folder(), "robot_ros2");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  const CommandOutcome outcome = run_pcavr(operator_arguments(port, "alice"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  robot.signal(SIGINT);
  EXPECT_EQ(robot.wait(), 0) << robot.errors();
  EXPECT_GT(result_of(robot)["commands"].get<int>(), 1000) << robot.output();
  std::ifstream setpoints(folder() / "setpoints.txt");
  std::vector<Eigen::Vector3d> path_base;
  std::vector<double> t;  // [s]
  double nanoseconds = 0, x = 0, y = 0, z = 0;
  while (setpoints >> nanoseconds >> x >> y >> z) {
    t.push_back(1e-9 * nanoseconds);
    path_base.emplace_back(x, y, z);
  }
  ASSERT_GT(path_base.size(), 1000U) << robot.errors();
  const auto recording = pcavr::read_file(folder() / "recording/tool.csv");
  ASSERT_TRUE(recording);
  const std::size_t last_row = recording->rfind('\n', recording->size() - 2) + 1;
  double end = 0;
  ASSERT_EQ(std::sscanf(recording->c_str() + last_row, "%lf,%lf,%lf,%lf", &end, &x, &y, &z), 4);
  EXPECT_LT((path_base.back() - Eigen::Vector3d(x, y, z)).norm(), 0.005);
  EXPECT_LT((path_base.front() - Eigen::Vector3d(0.2, 0.0, 0.1)).norm(), 1e-6);
  // The speed is within the site's limit, whatever the operator's hand did before the session. It
  // is measured by the stamps: a peer that a loaded machine delays receives the newest setpoint
  // only.
  const double max_speed = std::sqrt(3.0) * pcavr::MotionLimits().max_speed;
  constexpr double kSetpointAge = 0.02;  // [s] at most, when it is published
  for (std::size_t i = 1; i < path_base.size(); ++i) {
    ASSERT_LT((path_base[i] - path_base[i - 1]).norm(),
              max_speed * (t[i] - t[i - 1] + kSetpointAge))
        << i;
  }
}

TEST_F(TwoSites, WithWrongKeysAreOneErrorLineEach) {
  RunningCommand robot(robot_arguments(), folder(), "robot_keys");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  expect_one_line(run_pcavr(operator_arguments(port, "mallory")), "does not accept this key");
  const fs::path config = folder() / "short.yaml";
  std::ofstream(config) << "operator_site:\n  connection_timeout: 2\n";
  std::vector<std::string> wrong = operator_arguments(port, "alice", "mallory");
  wrong.insert(wrong.end(), {"--config", config.string()});
  expect_one_line(run_pcavr(wrong), "ended the handshake");
  expect_one_line(run_pcavr({"operator-site", path("scene"), "--trace", path("recording"), "--port",
                             std::to_string(port), "--config", config.string()}),
                  "ended the handshake");
  expect_one_line(run_pcavr(operator_arguments(port, "nobody")), "nobody.key");
  std::vector<std::string> second = robot_arguments();
  second[5] = std::to_string(port);
  expect_one_line(run_pcavr(second), "in use");
}

TEST_F(TwoSites, WithoutKeysUseLoopbackOnly) {
  expect_one_line(run_pcavr({"robot-site", path("scene"), "--recording", path("recording"),
                             "--port", "0", "--host", "0.0.0.0"}),
                  "keys");
  expect_one_line(run_pcavr({"operator-site", path("scene"), "--trace", path("recording"), "--host",
                             "192.0.2.1"}),
                  "keys");
}

// A peer of another version is answered in words.
TEST_F(TwoSites, OfOtherVersionsAreRejected) {
  RunningCommand robot(robot_arguments(), folder(), "robot_version");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  pcavr::LinkClient client =
      pcavr::LinkClient::open(
          {.port = static_cast<std::uint16_t>(port),
           .keys = pcavr::read_link_keys(path("keys/alice.key")).value(),
           .robot_key = pcavr::read_public_link_key(path("keys/robot.pub")).value()})
          .value();
  std::vector<std::uint8_t> hello = encode(pcavr::LinkMessage{{1, 5, 0.0}, pcavr::LinkHello{}});
  hello[4] = 7;
  std::optional<std::vector<std::uint8_t>> answer;
  for (int i = 0; i < 200 && !answer; ++i) {
    client.send(hello);
    client.wait(0.05);
    answer = client.receive();
  }
  ASSERT_TRUE(answer);
  const pcavr::Expected<pcavr::LinkMessage> message = pcavr::decode_link_message(*answer);
  ASSERT_TRUE(message);
  const auto* rejected = std::get_if<pcavr::LinkReject>(&message->content);
  ASSERT_NE(rejected, nullptr);
  EXPECT_EQ(rejected->reason, pcavr::LinkRejection::other_version);
}

// The simulated plant has a camera; its pictures are as old as the delay when they arrive.
TEST_F(TwoSites, ShowThePicturesOfTheRobotsCamera) {
  std::vector<std::string> robot_site = robot_arguments();
  std::replace(robot_site.begin(), robot_site.end(), std::string("--recording"),
               std::string("--plant"));
  std::replace(robot_site.begin(), robot_site.end(), path("recording"), std::string("push"));
  robot_site.insert(robot_site.end(), {"--seed", "3"});
  RunningCommand robot(robot_site, folder(), "robot_camera");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  std::vector<std::string> arguments = operator_arguments(port, "alice");
  arguments.insert(arguments.end(), {"--forward-delay", "0.2", "--backward-delay", "0.2"});
  RunningCommand site(arguments, folder(), "operator_camera");
  EXPECT_EQ(site.wait(), 0) << site.errors();  // the whole trace: a loaded machine has few pictures
  robot.signal(SIGINT);
  EXPECT_EQ(robot.wait(), 0) << robot.errors();
  const json at_operator = json::parse(site.output(), nullptr, false);
  const json at_robot = result_of(robot);
  EXPECT_GE(at_operator["pictures"].get<int>(), 3);
  EXPECT_LE(at_operator["pictures"].get<int>(), at_robot["pictures"].get<int>());
  EXPECT_GT(at_operator["picture_age_s"].get<double>(), 0.2);
  EXPECT_GT(at_robot["picture_bytes"].get<double>(), 1000.0 * at_robot["pictures"].get<double>());
  EXPECT_EQ(at_operator["invalid_messages"], 0);
}

// The operator's site is stopped for a time: the robot holds, and a new session follows.
TEST_F(TwoSites, HoldAndResumeAfterAnInterruption) {
  RunningCommand robot(robot_arguments(), folder(), "robot_hold");
  const int port = port_of(robot);
  ASSERT_GT(port, 0) << robot.errors();
  RunningCommand site(operator_arguments(port, "alice"), folder(), "operator_hold");
  ASSERT_TRUE(robot.has_said("operator's site connected"));
  std::this_thread::sleep_for(milliseconds(2000));
  site.signal(SIGSTOP);
  EXPECT_TRUE(robot.has_said("nothing from the operator's site"));
  std::this_thread::sleep_for(milliseconds(500));
  site.signal(SIGCONT);
  EXPECT_EQ(site.wait(), 0) << site.errors();
  EXPECT_EQ(robot.wait(), 0) << robot.errors();
  EXPECT_NE(site.errors().find("connected again"), std::string::npos) << site.errors();
  const json at_robot = result_of(robot);
  EXPECT_GE(at_robot["sessions"].get<int>(), 2);
  EXPECT_GE(at_robot["holds"].get<int>(), 1);
}

}  // namespace
