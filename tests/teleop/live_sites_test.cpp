// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/live_sites.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "teleop/plant_input.hpp"
#include "teleoperation/teleop/message.hpp"

namespace pcavr {
namespace {

/// Adds the samples of a recording that have arrived, in whatever batches the site runs.
class Samples {
 public:
  explicit Samples(const TeleopInput& input) : input_(input), tracked_(input.objects.size()) {}

  void add(double now, double tracking_latency, LiveRobotSite& site) {
    site.set_arrival(now);
    for (; tool_ < input_.t_tool.size() && input_.t_tool[tool_] <= now; ++tool_) {
      site.add_tool(input_.t_tool[tool_], input_.p_base_tip[tool_], Eigen::Quaterniond::Identity());
    }
    for (; force_ < input_.t_force.size() && input_.t_force[force_] <= now; ++force_) {
      site.add_wrench(input_.t_force[force_], input_.force_base[force_]);
    }
    for (std::size_t i = 0; i < tracked_.size(); ++i) {
      const std::vector<TrackedPose>& tracked = input_.objects[i].tracked;
      for (; tracked_[i] < tracked.size() && tracked[tracked_[i]].t + tracking_latency <= now;
           ++tracked_[i]) {
        site.add_tracked(i, tracked[tracked_[i]]);
      }
    }
  }

 private:
  const TeleopInput& input_;
  std::size_t tool_ = 0;
  std::size_t force_ = 0;
  std::vector<std::size_t> tracked_;
};

/// Corrections by `now` [s] of a site that does not wait for threads, which get `max_backlog`
/// cycles of virtual time.
std::vector<LiveCorrection> advance(LiveRobotSite& site, double now, std::size_t max_backlog) {
  std::vector<LiveCorrection> corrections = site.advance(now);
  while (site.backlog() > max_backlog) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    for (LiveCorrection& more : site.advance(now)) corrections.push_back(std::move(more));
  }
  return corrections;
}

/// Both live sites. The robot's runs every 1 to `max_cycles` cycles, `late` [s] after the last of
/// them. A correction is in each command from `delay` [s] after its composition on. `max_backlog`:
/// of a robot's site that does not wait for its threads.
std::vector<SentCorrection> run_live(const TeleopInput& input, const TeleopOptions& options,
                                     double delay, std::size_t max_cycles, double late,
                                     std::optional<std::size_t> max_backlog = {}) {
  RecordedCommand command = RecordedCommand::create(input, options).value();
  const double start = command.start();
  auto robot = LiveRobotSite::create(input, options, start).value();
  auto person = LiveOperatorSite::create(input, options, start, command.p_base_tip(0)).value();
  if (max_backlog) robot.set_waiting(false);
  std::size_t delayed = 0;
  Samples samples(input);
  std::deque<LiveCorrection> in_flight;
  std::vector<SentCorrection> sent;
  std::vector<LinkPrediction> predictions;
  Random random(5);
  for (std::size_t k = 1; k <= command.cycles();) {
    const std::size_t end = k + 1 + random.below(max_cycles);
    double t = 0.0;
    for (; k < end && k <= command.cycles(); ++k) {
      t = start + options.predictor.step * static_cast<double>(k);
      for (; !in_flight.empty() && in_flight.front().due <= t; in_flight.pop_front()) {
        EXPECT_TRUE(person.apply(in_flight.front().sent.t, in_flight.front().bytes));
      }
      person.step(command.p_base_tip(k), command.a_base_tip(k));
      person.get_predictions(predictions);
      robot.add_predictions(t + 3e-10, predictions, delay);  // as the shared clock rounds it
    }
    samples.add(t + late, options.pose.tracking_latency, robot);
    for (LiveCorrection& correction : advance(robot, t + late, max_backlog.value_or(0))) {
      sent.push_back(correction.sent);
      in_flight.push_back(std::move(correction));
    }
    if (robot.backlog() > 0) ++delayed;
  }
  EXPECT_EQ(delayed > 0, max_backlog.has_value());
  return sent;
}

void expect_same(const std::vector<SentCorrection>& live,
                 const std::vector<SentCorrection>& replayed) {
  ASSERT_EQ(live.size(), replayed.size());
  for (std::size_t i = 0; i < live.size(); ++i) {
    EXPECT_NEAR(live[i].t, replayed[i].t, 1e-5) << i;  // the unit of time in a message
    EXPECT_EQ(live[i].object, replayed[i].object) << i;
    EXPECT_EQ(live[i].which, replayed[i].which) << i;
    EXPECT_EQ(live[i].what, replayed[i].what) << i;
  }
}

TEST(LiveSites, SendTheCorrectionsOfAReplayHoweverLateTheyRun) {
  const PlantInput made = plant_input(3, false);
  TeleopOptions options;
  options.backward_delay = 0.2005;  // the commands' times don't decide by their last digit
  const TeleopRun replayed = run_teleop(made.input, options).value();
  ASSERT_GT(replayed.corrections.size(), 5U);
  expect_same(run_live(made.input, options, options.round_trip(), 1, 0.0), replayed.corrections);
  expect_same(run_live(made.input, options, options.round_trip(), 60, 0.1), replayed.corrections);
}

TEST(LiveSites, ProcessAFewCyclesAtATimeWhereALoopMustGoOn) {
  const PlantInput made = plant_input(3, false);
  const TeleopOptions options;
  auto robot = LiveRobotSite::create(made.input, options, 0.0).value();
  robot.set_waiting(false);
  const std::vector<LinkPrediction> predictions(made.input.objects.size());
  for (int i = 1; i <= 900; ++i) robot.add_predictions(1e-3 * i, predictions);
  static_cast<void>(robot.advance(0.9));
  EXPECT_GT(robot.backlog(), 850U);
  for (int i = 0; i < 900 && robot.backlog() > 0; ++i) static_cast<void>(robot.advance(0.9));
  EXPECT_EQ(robot.backlog(), 0U);
}

TEST(LiveSites, SendTheSameCorrectionsIfTheyDoNotWaitForThreads) {
  const PlantInput made = plant_input(3, false);
  TeleopOptions options;
  options.backward_delay = 0.2005;
  const TeleopRun replayed = run_teleop(made.input, options).value();
  expect_same(run_live(made.input, options, options.round_trip(), 1, 0.0, 100),
              replayed.corrections);
}

// The delay is that of the session, whatever the robot site's own options expect.
TEST(LiveSites, CountWithTheDelayThatCommandsState) {
  const PlantInput made = plant_input(3, false);
  TeleopOptions slow;
  slow.forward_delay = 0.3;
  slow.backward_delay = 0.2505;
  const TeleopRun replayed = run_teleop(made.input, slow).value();
  TeleopOptions robot = slow;
  robot.forward_delay = 0.2;
  robot.backward_delay = 0.2;
  expect_same(run_live(made.input, robot, slow.round_trip(), 20, 0.01), replayed.corrections);
}

// Pressed and held, two worlds feel the same if one has the arm's compliance, and the tip of the
// other is commanded to where that puts it.
TEST(LiveSites, GiveWayAsTheRobotsArmDoes) {
  constexpr double kCompliance = 5e-5;  // [m/N]
  TeleopInput input = plant_input(3, true).input;
  input.objects.resize(1);
  const Eigen::Vector3d centre = input.objects.front().T_base_object.translation();
  const Eigen::Vector3d begin = centre - Eigen::Vector3d(0.2, 0.0, 0.0);
  const auto create = [&] { return LiveOperatorSite::create(input, {}, 0.0, begin).value(); };
  LiveOperatorSite bent = create(), unbent = create(), moved = create();
  bent.set_tool_response({kCompliance, 63.0, 1.0, 0.0, 0.0});
  const auto force = [](const LiveOperatorSite& site) {
    return site.world().state().front().tool_force_base;
  };
  Eigen::Vector3d command = begin;
  for (int held = 0; held < 300;) {
    const bool is_held = held > 0 || force(bent).norm() > 2.0;  // far from its breakaway
    if (is_held) ++held;
    if (!is_held) command.x() += 1e-5;
    ASSERT_LT(command.x(), centre.x());
    bent.step(command);
    unbent.step(command);
    moved.step(command - kCompliance * force(bent));
  }
  const double felt = force(bent).norm();
  EXPECT_GT(felt, 1.0);
  EXPECT_GT(force(unbent).norm(), 1.03 * felt);
  EXPECT_NEAR(force(moved).norm(), felt, 0.005 * felt);
  bent.set_tool_response({});
  bent.step(begin);
  EXPECT_TRUE(force(bent).isZero());
}

// The correction is for a time that this world does not have, as at the begin of a session.
TEST(LiveSites, UseParametersThatComeTooLate) {
  const TeleopInput input = plant_input(3, true).input;
  const Eigen::Vector3d away = input.objects.front().T_base_object * Eigen::Vector3d(0.0, 0.0, 0.5);
  LiveOperatorSite site = LiveOperatorSite::create(input, {}, 5.0, away).value();
  site.step(away);
  const Pose before = site.world().T_base_object(0);
  CorrectionMessage message;
  message.t = 4.0;
  message.pose = planar_pose_of(before);
  message.pose->x += 0.01;
  const double stiffness = 2.0 * site.world().physics(0).contact.stiffness;
  message.parameters.contact_stiffness = ParameterValue{stiffness, 1.0};
  message.sequence = 1;
  EXPECT_TRUE(site.apply(message.t, encode(message, message.t)));
  EXPECT_EQ(site.late(), 1U);
  EXPECT_NEAR(site.world().physics(0).contact.stiffness, stiffness, 1e-3 * stiffness);
  EXPECT_EQ(planar_pose_of(site.world().T_base_object(0)).x, planar_pose_of(before).x);
}

// A sensor whose clock is a minute ahead is used when its samples arrive.
TEST(LiveSites, TakeSamplesWithAWrongClockAsTheyCome) {
  const PlantInput made = plant_input(3, false);
  LiveRobotSite site = LiveRobotSite::create(made.input, {}, 0.0).value();
  const std::vector<LinkPrediction> predictions(made.input.objects.size());
  site.set_arrival(0.001);
  site.add_wrench(60.001, Eigen::Vector3d::Zero());
  site.add_predictions(0.001, predictions);
  EXPECT_TRUE(site.advance(0.001).empty());
  EXPECT_GT(site.streaming_bytes(), 0U);
}

/// [s] from the loss of a contact's force to its end at the robot's site, while the tip moves on
/// at `speed` [m/s] along the push, and the camera sees the object where it was.
double time_to_notice_loss(double speed) {
  constexpr double kTouch = 1.0, kLoss = 2.0;  // [s]
  constexpr double kForce = 5.0;               // [N]
  TeleopInput input = plant_input(3, true).input;
  input.objects.resize(1);
  const Pose T_base_object = input.objects.front().T_base_object;
  Eigen::Vector3d tip = T_base_object.translation() - Eigen::Vector3d(0.2, 0.0, 0.0);
  LiveOperatorSite world = LiveOperatorSite::create(input, {}, 0.0, tip).value();
  while (world.world().state().front().tool_force_base.isZero()) {
    world.step(tip += Eigen::Vector3d(1e-4, 0.0, 0.0));
  }
  LiveRobotSite site = LiveRobotSite::create(input, {}, 0.0).value();
  const std::vector<LinkPrediction> predictions(1);
  Random random(6);
  for (int k = 0; k < 3000; ++k) {
    const double t = 1e-3 * k;
    const bool is_loaded = t > kTouch && t < kLoss;
    if (t < kTouch) tip.x() += 1e-6;
    if (t >= kLoss) tip.x() += 1e-3 * speed;
    site.set_arrival(t);
    if (k % 2 == 0) {
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      const Eigen::Vector3d force(is_loaded ? kForce : 0.0, 0.0, 0.0);
      site.add_tool(t, tip + 2e-5 * noise.reverse(), Eigen::Quaterniond::Identity());
      site.add_wrench(t, force + 0.08 * noise);
    }
    if (k % 33 == 0) site.add_tracked(0, {t, T_base_object, 2e-4, 1e-3});
    site.add_predictions(t, predictions);
    static_cast<void>(site.advance(t));
    const bool is_free = site.phase(0) == MotionPhase::free;
    if (k == 1900) {
      EXPECT_FALSE(is_free);
    }
    if (t > kLoss && is_free) return t - kLoss;
  }
  return 1.0;
}

// The force shows the loss, whatever the camera sees and the tip does.
TEST(LiveSites, NoticeTheLossOfAContactWithin50Milliseconds) {
  for (const double speed : {0.0, 0.03, -0.03}) EXPECT_LT(time_to_notice_loss(speed), 0.05);
}

/// One object, and the tip 0.5 mm before its face, where a correction of case 1.2b then puts it 1.5
/// mm inside. The site 0.2 s later, and the pose of the correction.
std::pair<LiveOperatorSite, PlanarPose> touched_by_robot(const TeleopOptions& options) {
  TeleopInput input = plant_input(3, true).input;
  input.objects.resize(1);
  const Pose T_base_object = input.objects.front().T_base_object;
  Eigen::Vector3d tip = T_base_object.translation() - Eigen::Vector3d(0.2, 0.0, 0.0);
  LiveOperatorSite site = LiveOperatorSite::create(input, options, 0.0, tip).value();
  const auto is_touched = [&] { return site.world().state().front().tool_force_base.norm() > 0.0; };
  while (!is_touched() && tip.x() < T_base_object.translation().x()) {
    tip.x() += 1e-5;
    site.step(tip);
  }
  for (int k = 0; k < 50; ++k) site.step(tip -= Eigen::Vector3d(1e-5, 0.0, 0.0));
  for (int k = 0; k < 200; ++k) site.step(tip);
  EXPECT_FALSE(is_touched());
  CorrectionMessage message;
  message.t = site.now() - 0.1;
  message.which = CorrectionCase::touched_by_robot;
  message.pose = planar_pose_of(T_base_object);
  message.pose->x -= 0.001;
  message.tool_retraction = Eigen::Vector3d(-0.0005, 0.0, 0.0);
  message.sequence = 1;
  EXPECT_TRUE(site.apply(message.t, encode(message, message.t)));
  for (int k = 0; k < 200; ++k) site.step(tip);
  return {std::move(site), *message.pose};
}

// Neither touches then, and the object is where the correction put it.
TEST(LiveSites, MoveTheToolOutOfWhatOnlyTheRobotHasTouched) {
  const auto [site, corrected] = touched_by_robot({});
  EXPECT_FALSE(site.retracts_from());
  EXPECT_GT(-site.tool_offset().x(), 0.0004);
  EXPECT_LT(-site.tool_offset().x(), 0.002);
  EXPECT_EQ(site.world().state().front().tool_force_base.norm(), 0.0);
  EXPECT_NEAR(planar_pose_of(site.world().T_base_object(0)).x, corrected.x, 2e-4);
}

TEST(LiveSites, LeaveTheToolWhereItIsWithoutASpeedOfRetraction) {
  TeleopOptions options;
  options.retraction_speed = 0.0;
  const auto [site, corrected] = touched_by_robot(options);
  EXPECT_EQ(site.tool_offset().norm(), 0.0);
  EXPECT_GT(site.world().state().front().tool_force_base.norm(), 0.0);
}

}  // namespace
}  // namespace pcavr
