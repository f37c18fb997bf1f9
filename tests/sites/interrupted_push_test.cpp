// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Both loops in virtual time on the simulated plant: what a push that is interrupted, and a robot
// that reports no numbers, do to it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/pipeline/plant_robot.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"

#include "sites/virtual_sites.hpp"
#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kBox = 0;
constexpr double kSpeed = 0.15;  // [m/s]
constexpr double kLeg = 0.25;    // [s] in one direction

/// Pushes a box wherever it is, from all sides and also up and down along its faces.
class RestlessPerson final : public OperatorInterface {
 public:
  explicit RestlessPerson(const Eigen::Vector3d& p_base_start) : p_base_(p_base_start) {}

  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t, const LinkState* state) override {
    if (state != nullptr) p_base_ = state->p_base_tip.cast<double>();
    return p_base_;
  }
  [[nodiscard]] OperatorCommand step(std::size_t, LiveOperatorSite& site,
                                     const OperatorLink&) override {
    if (cycles_++ % static_cast<int>(1e3 * kLeg) == 0) {
      const Eigen::Vector3d away = site.world().T_base_object(kBox).translation() - p_base_;
      const Eigen::Vector3d any(random_.normal(), random_.normal(), random_.normal());
      v_base_ = kSpeed * (away.normalized() + 0.7 * any.normalized()).normalized();
    }
    p_base_ += 1e-3 * v_base_;
    p_base_.z() = std::max(p_base_.z(), kMinHeight);
    site.step(p_base_);
    return {p_base_, Eigen::Quaterniond::Identity(), true, {}};
  }

 private:
  static constexpr double kMinHeight = 0.02;  // [m] above the table

  Random random_{7};
  Eigen::Vector3d p_base_, v_base_ = Eigen::Vector3d::Zero();
  int cycles_ = 0;
};

/// The plant; its wrench is no number from a time on, for a while, or it fails.
class CheckedRobot final : public RobotInterface {
 public:
  explicit CheckedRobot(std::unique_ptr<RobotInterface> plant) : plant_(std::move(plant)) {}
  [[nodiscard]] std::string name() const override { return "checked"; }
  [[nodiscard]] bool follows_commands() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override { return plant_->p_base_start(); }
  void set_command(const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond& q) override {
    setpoint = p_base_tip;
    plant_->set_command(p_base_tip, q);
  }
  void advance(double t, RobotSamples& samples) override {
    const bool is_faulty = t > faulty_from && t < faulty_from + 0.02;
    PCAVR_REQUIRE(!(is_faulty && throws), t);
    plant_->advance(t, samples);
    faults += samples.has_fault ? 1U : 0U;
    for (const RobotSamples::Tool& tool : samples.tool) {
      faults += tool.p_base_tip.allFinite() ? 0U : 1U;
    }
    for (RobotSamples::Wrench& wrench : samples.wrench) {
      max_force = std::max(max_force, wrench.force_base.norm());
      if (is_faulty) wrench.force_base.x() = std::numeric_limits<double>::quiet_NaN();
    }
  }

  double faulty_from = std::numeric_limits<double>::infinity();  ///< [s]
  bool throws = false;                                           ///< meanwhile
  Eigen::Vector3d setpoint = Eigen::Vector3d::Zero();
  std::size_t faults = 0;
  double max_force = 0.0;  ///< [N]

 private:
  std::unique_ptr<RobotInterface> plant_;
};

TeleopInput world_of(const PlantCase& plant) {
  TeleopInput world;
  for (const PlantBody& body : plant.bodies) {
    world.objects.push_back({body.name,
                             box_model(body.name, body.parts.front().half_extents),
                             body.T_base_object,
                             true_parameters(body.parameters),
                             {}});
  }
  world.tool_radius = plant.tool.radius;
  return world;
}

/// Both sites of a session without an end.
class RestlessSession {
 public:
  RestlessSession() {
    for (const TeleopObject& object : world_.objects) scene_.objects.push_back(object.name);
    const SiteRuntime runtime{.clock = [this] { return t; },
                              .new_session = [this] { return ++sessions_; },
                              .prepares_at_once = true};
    robot_site.steps =
        make_robot_site_steps(server_, robot, site_, scene_, robot_options_, observer_, runtime);
    operator_site.steps = make_operator_site_steps(client_, person_, world_, teleop_, scene_,
                                                   operator_options_, network_, observer_, runtime);
  }
  void run_until(double end) {
    run_in_virtual_time(robot_site, operator_site, wire_, t, [&] { return t > end; });
  }
  /// The operator's process does not run.
  void interrupt(double duration) {
    const double end = t + duration;
    while (t < end) {
      t = std::max(t, robot_site.next);
      robot_site.step(t);
    }
    operator_site.next = t;
  }
  [[nodiscard]] std::size_t warnings(const std::string& part) const {
    return static_cast<std::size_t>(std::count_if(
        warnings_.begin(), warnings_.end(),
        [&](const std::string& line) { return line.find(part) != std::string::npos; }));
  }

 private:
  TeleopInput world_ = world_of(make_plant_case(ToolTask::push, kSeed));
  TeleopOptions teleop_;
  SiteScene scene_{.name = "test", .version = "test", .objects = {}};
  RobotSiteOptions robot_options_;
  OperatorSiteOptions operator_options_;
  SimulatedNetwork network_{{.delay = 0.2}, {.delay = 0.2}, 1};
  std::vector<std::string> warnings_;
  Observer observer_{.progress = {},
                     .warn = [this](std::string_view line) { warnings_.emplace_back(line); },
                     .note = {}};
  std::uint32_t sessions_ = 0;
  Wire wire_;

 public:
  double t = 0.0;  ///< [s]
  CheckedRobot robot{
      make_plant_robot(ToolTask::push, kSeed, world_, teleop_.pose.tracking_latency).value()};
  SiteProcess<RobotSiteReport> robot_site;
  SiteProcess<OperatorSiteReport> operator_site;

 private:
  LiveRobotSite site_ = LiveRobotSite::create(world_, teleop_, 0.0).value();
  RestlessPerson person_{robot.p_base_start()};
  WireServer server_{wire_};
  WireClient client_{wire_, t};
};

TEST(InterruptedPush, LeavesThePlantFiniteAfterTwoHundredInterruptions) {
  RestlessSession session;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    session.run_until(session.t + random.uniform(0.3, 1.2));
    session.interrupt(random.uniform(0.01, 0.6));
  }
  session.run_until(session.t + 2.0);
  EXPECT_EQ(session.robot.faults, 0U);
  EXPECT_GT(session.robot.max_force, 5.0);  // it has pushed
  EXPECT_GT(session.robot_site.steps->finish().value().sessions, 50U);
}

TEST(InterruptedPush, ARobotThatFailsHoldsInItsSession) {
  for (const bool throws : {false, true}) {
    RestlessSession session;
    session.run_until(3.0);
    session.robot.faulty_from = 3.0;
    session.robot.throws = throws;
    session.run_until(3.5);
    EXPECT_EQ(session.warnings(throws ? "the robot can't be read: " : "values that are not valid"),
              1U);
    const Eigen::Vector3d held = session.robot.setpoint;
    session.run_until(4.5);
    EXPECT_EQ(session.robot.setpoint, held);
    const RobotSiteReport report = session.robot_site.steps->finish().value();
    EXPECT_EQ(report.sessions, 1U);
    EXPECT_GT(report.cycles, 4400U);  // at 1 kHz
  }
}

}  // namespace
}  // namespace pcavr
