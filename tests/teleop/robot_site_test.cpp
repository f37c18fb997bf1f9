// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/robot_site.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/inputs/tip_path.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

#include "teleop/plant_input.hpp"
#include "teleoperation/teleop/command_path.hpp"
#include "teleoperation/teleop/recording_feed.hpp"

namespace pcavr {
namespace {

/// The robot's site beside an operator's site that receives nothing, so that it keeps erring.
class LoneRobotSite {
 public:
  explicit LoneRobotSite(const TeleopInput& input, const TeleopOptions& options = {})
      : input_(input),
        options_(options),
        tip_(clean_tip_path(input.t_tool, input.p_base_tip, options_.inputs)),
        command_(tip_, height_over_objects(input), tip_.t.front(), options_.predictor.step) {
    for (const TeleopObject& object : input.objects) {
      physics_.push_back(complete_physics(object.parameters, object.model, object.T_base_object,
                                          options_.gravity(), options_.unknown_objects)
                             .physics);
    }
  }
  using Feed = std::function<void(double now, std::size_t cycle, RobotSite& robot)>;

  /// All corrections; `feed` passes the samples on.
  std::vector<CorrectionMessage> run(const Feed& feed, std::size_t max_cycles = 1000000) {
    const double start = tip_.t.front(), step = options_.predictor.step;
    Expected<OperatorSite> site =
        OperatorSite::create(input_, physics_, options_, start, command_.at(0));
    RobotSite robot(input_, options_, physics_, start, background);
    PredictionLog log(start, step, input_.objects.size());
    std::vector<CorrectionMessage> sent;
    const auto cycles = static_cast<std::size_t>((tip_.t.back() - start) / step);
    for (std::size_t k = 1; k <= std::min(cycles, max_cycles); ++k) {
      const double now = start + step * static_cast<double>(k);
      site->step(now, command_.at(k), command_.acceleration_at(k));
      for (std::size_t i = 0; i < input_.objects.size(); ++i) log.append(site->prediction(i));
      feed(now, k, robot);
      for (CorrectionMessage& message : robot.advance(now, log)) sent.push_back(message);
      log.discard_before(robot.oldest_needed());
    }
    robot.apply_identifications();
    static_cast<void>(robot.findings());
    notes = robot.notes();
    failures = robot.take_failures();
    return sent;
  }
  Background background;
  std::vector<std::string> notes, failures;

 private:
  const TeleopInput& input_;
  TeleopOptions options_;
  TipPath tip_;
  CommandPath command_;
  std::vector<BodyPhysics> physics_;
};

void expect_same(const std::vector<CorrectionMessage>& one,
                 const std::vector<CorrectionMessage>& two) {
  ASSERT_FALSE(one.empty());
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(encode(one[i], 0.0), encode(two[i], 0.0)) << i;
  }
}

TEST(RobotSite, GivesTheSameForAnyInterleavingWithinACycle) {
  const PlantInput made = plant_input(3, false);
  const TeleopInput& input = made.input;
  LoneRobotSite site(input);
  RecordingFeed in_order(input, 0.03);
  const auto expected = site.run(
      [&](double now, std::size_t, RobotSite& robot) { in_order.notify_change(now, robot); });
  // Tracking first, then the force, then the tool.
  std::size_t tool = 0, force = 0;
  std::vector<std::size_t> tracked(input.objects.size(), 0);
  const auto reversed = site.run([&](double now, std::size_t, RobotSite& robot) {
    for (std::size_t i = tracked.size(); i-- > 0;) {
      const std::vector<TrackedPose>& poses = input.objects[i].tracked;
      for (; tracked[i] < poses.size() && poses[tracked[i]].t + 0.03 <= now; ++tracked[i]) {
        robot.add_tracked(i, poses[tracked[i]]);
      }
    }
    for (; force < input.t_force.size() && input.t_force[force] <= now; ++force) {
      robot.add_wrench(input.t_force[force], input.force_base[force]);
    }
    for (; tool < input.t_tool.size() && input.t_tool[tool] <= now; ++tool) {
      robot.add_tool(input.t_tool[tool], input.p_base_tip[tool]);
    }
  });
  expect_same(expected, reversed);
}

TEST(RobotSite, CorrectsTheSameTimesIfSamplesArriveInBursts) {
  const PlantInput made = plant_input(3, false);
  LoneRobotSite site(made.input);
  RecordingFeed even(made.input, 0.03), bursts(made.input, 0.03);
  const auto expected =
      site.run([&](double now, std::size_t, RobotSite& robot) { even.notify_change(now, robot); });
  const auto late = site.run([&](double now, std::size_t cycle, RobotSite& robot) {
    if (cycle % 5 == 0) bursts.notify_change(now, robot);
  });
  ASSERT_GT(expected.size(), 2U);
  ASSERT_EQ(expected.size(), late.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(expected[i].t, late[i].t, 0.005) << i;
    EXPECT_EQ(expected[i].which, late[i].which) << i;
  }
}

TEST(RobotSite, IgnoresAndNotesBadSamples) {
  const PlantInput made = plant_input(3, false);
  LoneRobotSite site(made.input);
  RecordingFeed sound(made.input, 0.03), disturbed(made.input, 0.03);
  const auto expected = site.run(
      [&](double now, std::size_t, RobotSite& robot) { sound.notify_change(now, robot); }, 6000);
  EXPECT_TRUE(site.notes.empty());
  const auto same = site.run(
      [&](double now, std::size_t cycle, RobotSite& robot) {
        disturbed.notify_change(now, robot);
        if (cycle < 200 || cycle % 10 != 0) return;
        robot.add_tool(now - 1.0, Eigen::Vector3d::Zero());
        robot.add_wrench(now, Eigen::Vector3d::Constant(std::nan("")));
        robot.add_wrench(std::numeric_limits<double>::infinity(), Eigen::Vector3d::Zero());
        robot.add_tracked(0, {now - 1.0, Pose(), 1e-3, 1e-2});
      },
      6000);
  expect_same(expected, same);
  EXPECT_EQ(site.notes.size(), 3U);
}

TEST(RobotSite, RejectsAndNotesPosesOfATrackerThatFlips) {
  const PlantInput made = plant_input(3, false);
  LoneRobotSite site(made.input);
  RecordingFeed sound(made.input, 0.03), disturbed(made.input, 0.03);
  const auto expected = site.run(
      [&](double now, std::size_t, RobotSite& robot) { sound.notify_change(now, robot); }, 6000);
  const Pose flip(Eigen::Quaterniond(Eigen::AngleAxisd(1.6, Eigen::Vector3d::UnitX())),
                  Eigen::Vector3d::Zero());
  const auto same = site.run(
      [&](double now, std::size_t cycle, RobotSite& robot) {
        disturbed.notify_change(now, robot);
        if (cycle < 500 || cycle % 500 != 0) return;
        // The pose comes after the frames that have come.
        robot.add_tracked(
            0, {now - 0.03 + 1e-9, made.input.objects[0].T_base_object * flip, 1e-3, 1e-2});
      },
      6000);
  expect_same(expected, same);
  ASSERT_EQ(site.notes.size(), 1U);
  EXPECT_NE(site.notes[0].find("the pose jumps and returns"), std::string::npos);
}

// Case 2 of paper C: off the object until it is identified anew, and then it may go on.
TEST(RobotSite, KeepsTheToolOffUntilTheContactIsIdentified) {
  PlantInput made = plant_input(3, true);
  for (TeleopObject& object : made.input.objects) {
    object.parameters.limiting_static_friction->value *= 0.5;
    object.parameters.sliding_friction_coefficient->value *= 0.5;
  }
  TeleopOptions options;
  options.correction_switch.keeps_off = true;
  LoneRobotSite site(made.input, options);
  RecordingFeed feed(made.input, 0.03);
  const auto sent =
      site.run([&](double now, std::size_t, RobotSite& robot) { feed.notify_change(now, robot); });
  std::vector<bool> is_kept_off(made.input.objects.size(), false);
  int releases = 0;
  for (const CorrectionMessage& message : sent) {
    if (message.which != CorrectionCase::phases_differ || !message.tool_retraction) continue;
    const bool is_release = message.tool_retraction->isZero();
    EXPECT_EQ(is_kept_off[message.object], is_release) << message.t;
    is_kept_off[message.object] = !is_release;
    if (!is_release) {
      EXPECT_LT(message.tool_retraction->norm(), 0.01);
      continue;
    }
    ++releases;
    ASSERT_TRUE(message.parameters.limiting_static_friction);
    const PlantBody& body = made.plant.bodies[message.object];
    const double truth = body.parameters.limiting_static_friction;
    EXPECT_NEAR(message.parameters.limiting_static_friction->value, truth, 0.15 * truth);
  }
  EXPECT_GT(releases, 0);
}

/// Each call of a task of this name throws.
Background failing(std::launch policy, const std::string& name) {
  return {policy, [name](const char* task) { PCAVR_REQUIRE(name != task, "made to fail"); }};
}

TEST(RobotSite, GoesOnWithWhatItHadWhereATaskFails) {
  const PlantInput made = plant_input(3, false);
  struct Case {
    std::launch policy;
    std::string task;
  };
  for (const Case& one : {Case{std::launch::deferred, PendingIdentification::kTask},
                          Case{std::launch::async, PendingSearch::kTask},
                          Case{std::launch::async, PendingTrial::kTask},
                          Case{std::launch::deferred, InputWatch::kTask}}) {
    LoneRobotSite site(made.input);
    site.background = failing(one.policy, one.task);
    RecordingFeed feed(made.input, 0.03);
    const auto sent = site.run(
        [&](double now, std::size_t, RobotSite& robot) { feed.notify_change(now, robot); });
    // A correction that could not be tried is not sent.
    EXPECT_EQ(sent.empty(), one.task == PendingTrial::kTask) << one.task;
    const std::string expected = one.task + " failed, and what was known before is kept: ";
    ASSERT_FALSE(site.failures.empty()) << one.task;
    for (const std::string& failure : site.failures) {
      EXPECT_EQ(failure.rfind(expected, 0), 0U) << failure;
      EXPECT_NE(failure.find("made to fail"), std::string::npos) << failure;
    }
    // A failure is noted once for the whole session; a live site also reports each one.
    EXPECT_EQ(std::count(site.notes.begin(), site.notes.end(), site.failures.front()), 1);
  }
}

TEST(RobotSite, SendsAllOfItsStateAfterAnOutage) {
  const PlantInput made = plant_input(3, false);
  LoneRobotSite site(made.input);
  RecordingFeed feed(made.input, 0.03);
  constexpr std::size_t kOutage = 2000;
  std::optional<double> back;
  const auto sent = site.run(
      [&](double now, std::size_t cycle, RobotSite& robot) {
        feed.notify_change(now, robot);
        if (cycle != kOutage) return;
        robot.restart(now);
        back = now;
      },
      kOutage + 100);
  std::vector<bool> has_full_state(made.input.objects.size(), false);
  for (const CorrectionMessage& message : sent) {
    if (!back || message.t < *back || !message.pose) continue;
    if (!message.parameters.mass || !message.parameters.contact_stiffness) continue;
    has_full_state[message.object] = true;
  }
  for (const bool has : has_full_state) EXPECT_TRUE(has);
}

}  // namespace
}  // namespace pcavr
