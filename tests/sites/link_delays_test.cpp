// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

namespace pcavr {
namespace {

constexpr double kDelay = 0.05;       // [s] of the simulated network, each way
constexpr double kRobotCycle = 0.02;  // [s] long, so that a stamp of another cycle is seen
constexpr double kMaxError = 1e-3;    // [s]
constexpr std::size_t kDelays = 60;   // commands whose way is compared
constexpr double kTimeout = 10.0;     // [s]: a busy machine is no silent network

double outside_clock() { return read_clock(CLOCK_MONOTONIC); }

/// Notes by the outside clock when it is commanded and when it measures.
class StampedRobot final : public RobotInterface {
 public:
  [[nodiscard]] std::string name() const override { return "test"; }
  [[nodiscard]] bool follows_commands() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override { return Eigen::Vector3d::Zero(); }
  void set_command(const Eigen::Vector3d&, const Eigen::Quaterniond&) override {
    applied.push_back(outside_clock());
  }
  void advance(double t, RobotSamples& samples) override {
    samples.tool.push_back({t, Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity()});
    sensed.push_back(outside_clock());
  }
  std::vector<double> applied;
  std::vector<double> sensed;
};

/// Notes when it sends, and what it learns of each command's way.
class StampedOperator final : public OperatorInterface {
 public:
  explicit StampedOperator(std::atomic<bool>& stop) : stop_(stop) {}
  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t, const LinkState*) override {
    return Eigen::Vector3d::Zero();
  }
  [[nodiscard]] OperatorCommand step(std::size_t, LiveOperatorSite& site,
                                     const OperatorLink& link) override {
    site.step(Eigen::Vector3d::Zero());
    if (link.delays && (delays.empty() || delays.back().sent != link.delays->sent)) {
      delays.push_back(*link.delays);
      if (delays.size() == kDelays) stop_ = true;
    }
    sent.push_back(outside_clock());
    return {Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), true, sent.back()};
  }
  std::vector<double> sent;
  std::vector<DelayStamps> delays;

 private:
  std::atomic<bool>& stop_;
};

double distance_to_nearest(const std::vector<double>& times, double t) {
  double nearest = 1e9;
  for (const double time : times) nearest = std::min(nearest, std::abs(time - t));
  return nearest;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 1e9 : values[values.size() / 2];
}

// Each stage ends when the site's own hands saw it end, by a clock that the link does not use.
TEST(LinkDelays, EachStageAgreesWithAnOutsideClockWithinAMillisecond) {
  Expected<LinkServer> server = LinkServer::open({});
  ASSERT_TRUE(server) << server.error().to_string();
  Expected<LinkClient> client = LinkClient::open({.port = server->port()});
  ASSERT_TRUE(client) << client.error().to_string();
  const TeleopInput world;
  const TeleopOptions teleop;
  const SiteScene scene{.name = "test", .version = "test", .objects = {}};
  Expected<LiveRobotSite> site = LiveRobotSite::create(world, teleop, 0.0);
  ASSERT_TRUE(site);
  RobotSiteOptions robot_options;
  robot_options.cycle = kRobotCycle;
  robot_options.commands.timeout = kTimeout;
  OperatorSiteOptions operator_options;
  operator_options.timeout = kTimeout;
  std::atomic<bool> stop = false;
  StampedRobot robot;
  long robot_waits = 0;
  std::size_t commands = 0;
  std::thread robot_thread([&] {
    const auto done = run_robot_site(*server, robot, *site, scene, robot_options, {}, stop);
    ASSERT_TRUE(done) << done.error().to_string();
    commands = done->commands;
    rusage usage{};
    ::getrusage(RUSAGE_THREAD, &usage);
    robot_waits = usage.ru_nvcsw;
  });
  StampedOperator person(stop);
  SimulatedNetwork network;
  network.forward.delay = network.backward.delay = kDelay;
  const Expected<OperatorSiteReport> report =
      run_operator_site(*client, person, world, teleop, scene, operator_options, network, {}, stop);
  stop = true;
  robot_thread.join();
  ASSERT_TRUE(report) << report.error().to_string();

  ASSERT_EQ(person.delays.size(), kDelays);
  std::vector<double> of_sent;
  std::vector<double> of_applied;
  std::vector<double> of_sensed;
  std::vector<double> of_sum;
  double fastest_forward = 1e9;
  double fastest_backward = 1e9;
  for (const DelayStamps& stamps : person.delays) {
    of_sent.push_back(distance_to_nearest(person.sent, stamps.sent));
    of_applied.push_back(distance_to_nearest(robot.applied, stamps.applied));
    of_sensed.push_back(distance_to_nearest(robot.sensed, stamps.sensed));
    // The time from the device's own stamp to the arrival, by the outside clock, is compared with
    // the stages.
    const double stages = (stamps.received - stamps.sent) + (stamps.applied - stamps.received) +
                          (stamps.sensed - stamps.applied) + (stamps.sent_back - stamps.sensed) +
                          (stamps.received_back - stamps.sent_back);
    ASSERT_TRUE(stamps.device_clock);
    of_sum.push_back(std::abs(stages - (stamps.received_back - *stamps.device_clock)));
    EXPECT_LE(stamps.received, stamps.applied);
    EXPECT_LE(stamps.applied, stamps.sensed + 1e-9);
    EXPECT_LE(stamps.sensed, stamps.sent_back + 1e-9);
    fastest_forward = std::min(fastest_forward, stamps.received - stamps.sent);
    fastest_backward = std::min(fastest_backward, stamps.received_back - stamps.sent_back);
  }
  // A busy machine delays messages, by which round trips know the other clock less well.
  const double max_error = kMaxError + 0.5 * std::max(0.0, report->round_trip - 2.0 * kDelay);
  EXPECT_LT(median(of_sent), kMaxError);
  EXPECT_LT(median(of_applied), max_error);
  EXPECT_LT(median(of_sensed), max_error);
  EXPECT_LT(median(of_sum), kMaxError);
  EXPECT_GT(fastest_forward, kDelay - max_error);
  EXPECT_GT(fastest_backward, kDelay - max_error);
  EXPECT_LT(fastest_forward, kDelay + 0.02);
  EXPECT_LT(fastest_backward, kDelay + 0.02);
  // Its cycles receive the commands: it does not wake for each of them.
  EXPECT_LT(robot_waits, static_cast<long>(commands / 2)) << commands;
  EXPECT_EQ(report->delays.stages()[0].name, "sent to received");
  EXPECT_GE(report->delays.count(), person.delays.size());
}

}  // namespace
}  // namespace pcavr
