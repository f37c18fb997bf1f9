// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Both loops in virtual time on the simulated plant: what each does for the other.
#include "sites/virtual_sites.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/pipeline/plant_robot.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"

#include "teleop/plant_input.hpp"
#include "teleop/retraction_message.hpp"

namespace pcavr {
namespace {

constexpr std::uint64_t kSeed = 43;   // an arm of 37 N/mm
constexpr double kTravelSpeed = 0.1;  // [m/s]
constexpr double kPushSpeed = 0.01;   // [m/s]
constexpr double kDepth = 0.0012;     // [m] of the command, static
constexpr double kHold = 1.0;         // [s]
constexpr int kPushes = 4;
constexpr std::size_t kBox = 1;  // the rubber-faced one

/// Travels in a straight line, then pushes a box a few times without moving it.
class PushingPerson final : public OperatorInterface {
 public:
  PushingPerson(const Eigen::Vector3d& p_base_start, const Eigen::Vector3d& p_base_face)
      : p_base_(p_base_start) {
    const Eigen::Vector3d back = p_base_face - Eigen::Vector3d(0.0, 0.005, 0.0);
    const Eigen::Vector3d pressed = p_base_face + Eigen::Vector3d(0.0, kDepth, 0.0);
    path_.push_back({{back.x(), back.y(), p_base_start.z()}, kTravelSpeed, 0.2});
    path_.push_back({back, kTravelSpeed, 0.5});
    for (int i = 0; i < kPushes; ++i) {
      path_.push_back({pressed, kPushSpeed, kHold});
      path_.push_back({back, kPushSpeed, 0.5});
    }
    path_.pop_back();
  }

  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t, const LinkState*) override {
    return p_base_;
  }
  [[nodiscard]] OperatorCommand step(std::size_t, LiveOperatorSite& site,
                                     const OperatorLink&) override {
    move();
    if (retraction_ != 0.0 && is_before_box_) {
      const Eigen::Vector3d up(0.0, 0.0, std::exchange(retraction_, 0.0));
      EXPECT_TRUE(site.apply(site.now(), retraction_message(site.now(), kBox, up)));
    }
    site.step(p_base_);
    offset_ = site.tool_offset();
    site.get_predictions(predictions_);
    p_box_command_ = site.world().T_base_object(kBox).inverse() * p_base_;
    return {p_base_, Eigen::Quaterniond::Identity(), true, {}};
  }
  [[nodiscard]] bool is_done() const { return next_ == path_.size(); }
  /// [m] Upwards, as of a correction of case 1.2b that arrives before the box.
  void retract_before_box(double displacement) { retraction_ = displacement; }
  [[nodiscard]] const Eigen::Vector3d& p_base_command() const { return p_base_; }
  [[nodiscard]] const Eigen::Vector3d& offset() const { return offset_; }
  /// [N] in the newest cycle.
  [[nodiscard]] double predicted_force() const { return predictions_[kBox].force.norm(); }
  /// The command in the frame of the predicted box.
  [[nodiscard]] const Eigen::Vector3d& p_box_command() const { return p_box_command_; }

 private:
  struct Waypoint {
    Eigen::Vector3d p_base;
    double speed;
    double rest;  ///< [s]
  };
  void move() {
    if (is_done()) return;
    constexpr double kStep = 0.001;  // [s]
    const Waypoint& to = path_[next_];
    const Eigen::Vector3d displacement = to.p_base - p_base_;
    const double reach = to.speed * kStep;
    if (displacement.norm() > reach) {
      p_base_ += reach * displacement.normalized();
      return;
    }
    p_base_ = to.p_base;
    is_before_box_ = next_ == 0;
    rested_ += kStep;
    if (rested_ < to.rest) return;
    rested_ = 0.0;
    ++next_;
  }

  Eigen::Vector3d p_base_;
  std::vector<Waypoint> path_;
  std::size_t next_ = 0;
  double rested_ = 0.0;  ///< [s]
  double retraction_ = 0.0;
  bool is_before_box_ = false;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_box_command_ = Eigen::Vector3d::Zero();
  std::vector<LinkPrediction> predictions_;
};

/// The plant, with what was commanded and measured.
class ObservedRobot final : public RobotInterface {
 public:
  explicit ObservedRobot(std::unique_ptr<RobotInterface> plant) : plant_(std::move(plant)) {}
  [[nodiscard]] std::string name() const override { return "observed"; }
  [[nodiscard]] bool follows_commands() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override { return plant_->p_base_start(); }
  void set_command(const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond& q) override {
    setpoints.push_back(p_base_tip);
    plant_->set_command(p_base_tip, q);
  }
  void advance(double t, RobotSamples& samples) override {
    plant_->advance(t, samples);
    for (const RobotSamples::Wrench& wrench : samples.wrench) {
      force += 0.02 * (wrench.force_base.norm() - force);
    }
  }

  std::vector<Eigen::Vector3d> setpoints;  ///< one a cycle
  double force = 0.0;                      ///< [N] mean of the last samples

 private:
  std::unique_ptr<RobotInterface> plant_;
};

struct Session {
  PlantCase plant = make_plant_case(ToolTask::paper, kSeed);
  std::vector<Eigen::Vector3d> setpoints;
  double measured = 0.0;   ///< [N] at the end of the last push
  double predicted = 0.0;  ///< [N] the same at the operator's site
  double pressed = 0.0;    ///< [m] of its command in its box, the same
  Eigen::Vector3d p_base_command = Eigen::Vector3d::Zero();  ///< of the person, at the end
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();          ///< the tool's, at the end
  RobotSiteReport robot;
};

constexpr double kNever = 1e9;  // [s]

/// `reconnected`: when the operator's messages come over another connection [s].
Session run_session(const LinkConditions::Options& link, double retraction = 0.0,
                    double reconnected = kNever) {
  Session session;
  TeleopInput world;
  for (const PlantBody& body : session.plant.bodies) {
    world.objects.push_back({body.name,
                             box_model(body.name, body.parts.front().half_extents),
                             body.T_base_object,
                             true_parameters(body.parameters),
                             {}});
  }
  world.tool_radius = session.plant.tool.radius;
  SiteScene scene{.name = "test", .version = "test", .objects = {}};
  for (const TeleopObject& object : world.objects) scene.objects.push_back(object.name);
  const TeleopOptions teleop;
  ObservedRobot robot(
      make_plant_robot(ToolTask::paper, kSeed, world, teleop.pose.tracking_latency).value());
  LiveRobotSite site = LiveRobotSite::create(world, teleop, 0.0).value();
  const PlantBody& box = session.plant.bodies[kBox];
  const double reach = box.parts.front().half_extents.y() + world.tool_radius;
  const Eigen::Vector3d face = box.T_base_object * Eigen::Vector3d(0.0, -reach, 0.0);
  PushingPerson person(robot.p_base_start(), face);
  person.retract_before_box(retraction);
  const RobotSiteOptions robot_options;
  const OperatorSiteOptions operator_options;
  const SimulatedNetwork network{link, link, 1};
  const Observer observer;
  Wire wire;
  double t = 0.0;
  WireServer server(wire);
  WireClient client(wire, t);
  std::uint32_t sessions = 0;
  const SiteRuntime runtime{.clock = [&t] { return t; },
                            .new_session = [&sessions] { return ++sessions; },
                            .prepares_at_once = true};
  SiteProcess<RobotSiteReport> robot_site{
      make_robot_site_steps(server, robot, site, scene, robot_options, observer, runtime)};
  SiteProcess<OperatorSiteReport> operator_site{make_operator_site_steps(
      client, person, world, teleop, scene, operator_options, network, observer, runtime)};
  run_in_virtual_time(robot_site, operator_site, wire, t, [&] {
    if (t > reconnected) wire.peer = "operator again";
    return person.is_done() || operator_site.steps->is_finished() || t > 60.0;
  });
  EXPECT_TRUE(person.is_done());
  session.predicted = person.predicted_force();
  session.p_base_command = person.p_base_command();
  session.offset = person.offset();
  session.pressed = reach + person.p_box_command().y();
  // The last command is executed later; the robot then holds.
  const double end = t + 0.2;
  run_in_virtual_time(robot_site, operator_site, wire, t, [&] { return t > end; });
  session.measured = robot.force;
  session.setpoints = robot.setpoints;
  session.robot = robot_site.steps->finish().value();
  const OperatorSiteReport report = operator_site.steps->finish().value();
  EXPECT_GE(report.corrections, world.objects.size());  // the whole state at the session's begin
  EXPECT_EQ(report.late_corrections, 0U);
  return session;
}

// The operator's tip gives way as the robot's arm does: by what its command is deeper in the
// predicted box than the contact's law has it for the predicted force. (How far that force is from
// the measured one is decided by the box's tracked pose, 0.1 mm of which are a newton.)
TEST(VirtualSites, MoveTheOperatorsTipAsAnArmThatGivesWay) {
  LinkConditions::Options link;
  link.delay = 0.05;
  const Session session = run_session(link);
  ASSERT_TRUE(session.robot.tool_response);
  const double compliance = 1.0 / session.plant.tool.stiffness;
  EXPECT_NEAR(session.robot.tool_response->compliance, compliance, 0.05 * compliance);
  EXPECT_GT(session.measured, 3.0);
  const PlantParameters& law = session.plant.bodies[kBox].parameters;
  const double penetration =
      std::pow(session.predicted / law.contact_stiffness, 1.0 / law.contact_exponent);
  EXPECT_NEAR(session.pressed - penetration, compliance * session.predicted,
              0.3 * compliance * session.predicted);
}

// The robot is sent the command and what moves the tool out of what only the robot has touched.
TEST(VirtualSites, MoveTheRobotAsTheOperatorsToolIsRetracted) {
  LinkConditions::Options link;
  link.delay = 0.05;
  const Session session = run_session(link, 0.004);
  EXPECT_NEAR(session.offset.z(), 0.004, 1e-4);
  const Eigen::Vector3d expected = session.p_base_command + session.offset;
  EXPECT_LT((session.setpoints.back() - expected).norm(), 1e-5);
}

// TCP connects again before a site notices any silence: to the robot's site this is another peer.
// The operator's site must see that its commands are not executed, and begin a session.
TEST(VirtualSites, BeginASessionAfterTheConnectionWasMadeAgain) {
  LinkConditions::Options link;
  link.delay = 0.05;
  const Session session = run_session(link, 0.0, 3.0);
  EXPECT_EQ(session.robot.sessions, 2U);
  EXPECT_EQ(session.robot.holds, 1U);
  EXPECT_LT((session.setpoints.back() - session.p_base_command).norm(), 1e-5);
}

// Lost commands do not slow the tool down: its setpoint goes on towards the next that has arrived.
TEST(VirtualSites, KeepTheSpeedOfAToolWhoseCommandsAreLost) {
  LinkConditions::Options link;
  link.delay = 0.05;
  link.loss = 0.2;
  link.burst = 2.0;
  const Session session = run_session(link);
  std::vector<double> speeds;  // [m/s] of the first travel, without its begin and end
  Eigen::Vector3d first = session.setpoints.front();
  for (std::size_t i = 1; i < session.setpoints.size(); ++i) {
    const double displacement = (session.setpoints[i] - first).norm();
    if (displacement > 0.1) break;
    if (displacement < 0.03) continue;
    speeds.push_back(1e3 * (session.setpoints[i] - session.setpoints[i - 1]).norm());
  }
  ASSERT_GT(speeds.size(), 500U);
  std::sort(speeds.begin(), speeds.end());
  EXPECT_GT(speeds[speeds.size() / 20], 0.95 * kTravelSpeed);
}

}  // namespace
}  // namespace pcavr
