// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/live_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "serve/live_cycle_fixture.hpp"
#include "support/heap_counter.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

using test::kCycle;
using test::kInTheBox;
using test::LiveCycleTest;
using test::ScriptedDevice;

TEST_F(LiveCycleTest, TheToolStaysAtItsStartWhileDisengaged) {
  const WorldSnapshot& state = run(10);
  EXPECT_EQ(state.world.p_base_proxy, test::kToolStart);
  EXPECT_FALSE(state.world.is_engaged);
  EXPECT_EQ(state.cycles, 10U);
  EXPECT_NEAR(state.t, 0.01, 1e-12);
}

TEST_F(LiveCycleTest, AHandWithTheClutchClosedPushesTheBox) {
  const double before = run(1).world.bodies[0].T_base_object.translation().x();
  const WorldSnapshot& state = move(kInTheBox, 1500);
  EXPECT_GT(state.world.bodies[0].T_base_object.translation().x(), before + 0.05);
  EXPECT_LT(state.world.force_base.x(), 0.0);
  // A first contact, and a breakaway.
  EXPECT_GE(state.pulses, 2U);
  EXPECT_GT(state.pulse, 0.0);
}

TEST_F(LiveCycleTest, SlowedTimeRunsAtItsScaleWithForcesAsMuchSmaller) {
  run(1);
  cycle_.set_time_scale(0.25);
  const WorldSnapshot& slow = run(100);
  EXPECT_EQ(slow.time_scale, 0.25);
  EXPECT_NEAR(slow.t, kCycle * (1.0 + 25.0), 1e-9);
  // Ten seconds of hand for the push of 1.5 s above: the same force in the world, a quarter felt.
  const Eigen::Vector3d force = move(kInTheBox, 6000).world.force_base;
  LiveCycle fast(test::a_box_on_a_table(), std::make_unique<ScriptedDevice>(sample_),
                 test::options_with_tool_start());
  sample_.p_base_tip = test::kToolStart;
  for (int i = 1; i <= 1500; ++i) {
    sample_.p_base_tip = test::kToolStart + (kInTheBox - test::kToolStart) * (i / 1500.0);
    fast.step(kCycle * i);
    fast.publish(1e-5, 0, kCycle * i);
  }
  EXPECT_NEAR(force.x(), 0.25 * fast.newest().world.force_base.x(), 0.1 * std::abs(force.x()));
}

TEST_F(LiveCycleTest, TimeGoesFasterOnlyWhenNoForceActs) {
  run(1);
  cycle_.set_time_scale(0.1);
  move(kInTheBox, 3000);
  cycle_.set_time_scale(1.0);
  EXPECT_EQ(run(5).time_scale, 0.1);
  sample_.is_engaged = false;
  EXPECT_EQ(run(2000).time_scale, 1.0);
  cycle_.set_time_scale(0.0);
  EXPECT_EQ(run(2).time_scale, 0.1);
}

TEST_F(LiveCycleTest, SlowedTimeReturnsNoEnergyToTheHand) {
  run(1);
  cycle_.set_time_scale(0.25);
  run(1);
  double work = 0.0, lowest = 0.0;
  Eigen::Vector3d before = sample_.p_base_tip;
  for (int i = 1; i <= 8000; ++i) {
    // Into the box and out again, three times.
    const double phase = 0.5 - 0.5 * std::cos(2.0 * 3.14159265358979 * 3.0 * i / 8000.0);
    sample_.is_engaged = true;
    sample_.p_base_tip = test::kToolStart + phase * (kInTheBox - test::kToolStart);
    const Eigen::Vector3d force = cycle_.newest().world.force_base;
    work -= force.dot(sample_.p_base_tip - before);
    before = sample_.p_base_tip;
    lowest = std::min(lowest, work);
    run(1);
  }
  EXPECT_GT(work, 0.0);
  EXPECT_GT(lowest, -1e-4);  // [J]
}

/// A tool 0.2 m long that points down the base's -z, of 0.3 kg.
TEST_F(LiveCycleTest, TheHandFeelsTheToolsWeightAndTheTorqueOfTheForceAtItsTip) {
  LiveWorldOptions options = test::options_with_tool_start();
  options.tool.length = 0.2;
  options.tool.mass = 0.3;
  sample_.q_base_tool = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
  DeviceFeedback feedback;
  LiveCycle cycle(test::a_box_on_a_table(), std::make_unique<ScriptedDevice>(sample_, &feedback),
                  options);
  const auto run_to = [&](const Eigen::Vector3d& to, int cycles) {
    const Eigen::Vector3d from = sample_.p_base_tip;
    for (int i = 1; i <= cycles; ++i) {
      sample_.p_base_tip = from + (to - from) * (static_cast<double>(i) / cycles);
      cycle.step(kCycle * i);
    }
  };
  run_to(sample_.p_base_tip, 300);
  EXPECT_TRUE(feedback.force_base.isZero(0.0));  // the clutch is open
  sample_.is_engaged = true;
  const double weight = options.tool.weight();
  EXPECT_NEAR(weight, 2.942, 1e-3);
  run_to(sample_.p_base_tip, 300);
  EXPECT_LT((feedback.force_base - Eigen::Vector3d(0.0, 0.0, -weight)).norm(), 1e-9);
  EXPECT_LT(feedback.torque_base.norm(), 1e-9);  // it hangs
  run_to(kInTheBox, 1500);
  EXPECT_NEAR(feedback.force_base.z(), -weight, 0.1);
  EXPECT_LT(feedback.force_base.x(), -1.0);
  // The force at the tip, 0.2 m below the grip, acts along -x: about +y.
  EXPECT_NEAR(feedback.torque_base.y(), -0.2 * feedback.force_base.x(), 1e-6);
  EXPECT_NEAR(feedback.torque_base.z(), 0.0, 1e-9);
  // Level, along x: half of the length carries the weight, also about +y.
  sample_.q_base_tool = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY());
  run_to(test::kToolStart, 1500);
  run_to(sample_.p_base_tip, 300);
  EXPECT_NEAR(feedback.torque_base.y(), 0.1 * weight, 1e-9);
}

TEST_F(LiveCycleTest, WithoutTheClutchTheHandMovesNothing) {
  run(1);
  sample_.p_base_tip = kInTheBox;
  const WorldSnapshot& state = run(500);
  EXPECT_EQ(state.world.p_base_proxy, test::kToolStart);
  EXPECT_EQ(state.world.force_base, Eigen::Vector3d::Zero());
}

TEST_F(LiveCycleTest, OnHoldTheToolStaysAndResumesFromThere) {
  const Eigen::Vector3d there = test::kToolStart + Eigen::Vector3d(0.0, 0.1, 0.0);
  move(there, 200);
  cycle_.hold(true);
  const WorldSnapshot& frozen = move(there + Eigen::Vector3d(0.0, 0.1, 0.1), 200);
  EXPECT_TRUE(frozen.is_on_hold);
  EXPECT_TRUE(frozen.world.is_engaged);
  EXPECT_NEAR((frozen.world.p_base_hip - there).norm(), 0.0, 1e-12);
  cycle_.hold(false);
  EXPECT_NEAR((run(1).world.p_base_hip - there).norm(), 0.0, 1e-12);
  const WorldSnapshot& resumed = move(sample_.p_base_tip + Eigen::Vector3d(0.0, 0.0, 0.05), 100);
  EXPECT_NEAR((resumed.world.p_base_hip - there - Eigen::Vector3d(0.0, 0.0, 0.05)).norm(), 0.0,
              1e-9);
}

TEST_F(LiveCycleTest, OnHoldOpeningTheClutchDisengages) {
  move(test::kToolStart + Eigen::Vector3d(0.0, 0.1, 0.0), 200);
  cycle_.hold(true);
  run(10);
  sample_.is_engaged = false;
  EXPECT_FALSE(run(1).world.is_engaged);
  // Closing it does not engage until the world resumes.
  sample_.is_engaged = true;
  EXPECT_FALSE(run(10).world.is_engaged);
  cycle_.hold(false);
  EXPECT_TRUE(run(1).world.is_engaged);
}

TEST_F(LiveCycleTest, AnAbsentDeviceIsDisengaged) {
  move(test::kToolStart + Eigen::Vector3d(0.0, 0.1, 0.0), 200);
  sample_.is_present = false;
  const WorldSnapshot& state = run(10);
  EXPECT_FALSE(state.world.is_engaged);
  EXPECT_EQ(state.world.force_base, Eigen::Vector3d::Zero());
}

TEST_F(LiveCycleTest, AResetRestoresTheStartAndTheToolContinuesFromThere) {
  const WorldSnapshot start = run(1);
  move(kInTheBox, 1500);
  cycle_.reset();
  const WorldSnapshot& state = run(1);
  EXPECT_EQ(state.world.bodies[0].T_base_object.translation(),
            start.world.bodies[0].T_base_object.translation());
  EXPECT_NEAR((state.world.p_base_hip - test::kToolStart).norm(), 0.0, 1e-12);
  EXPECT_EQ(state.speeds[0], 0.0);
}

TEST_F(LiveCycleTest, AnUndoneResetPutsTheBodiesBackUntilOneIsTouched) {
  move(kInTheBox, 1500);
  cycle_.undo_reset();  // of nothing
  const Eigen::Vector3d pushed = run(1).world.bodies[0].T_base_object.translation();
  EXPECT_GT(pushed.x(), cycle_.newest().world.p_base_proxy.x());
  for (int i = 0; i < 2; ++i) {
    cycle_.reset();
    EXPECT_TRUE(run(1).world.can_undo_reset) << "also by a second one";
  }
  cycle_.undo_reset();
  const WorldSnapshot& state = run(1);
  EXPECT_EQ(state.world.bodies[0].T_base_object.translation(), pushed);
  EXPECT_EQ(state.world.bodies[0].phase, MotionPhase::free);
  EXPECT_FALSE(state.world.can_undo_reset);
  cycle_.reset();
  sample_.is_engaged = false;
  sample_.p_base_tip = test::kToolStart;
  EXPECT_TRUE(run(1).world.can_undo_reset);
  move(kInTheBox, 1500);
  EXPECT_FALSE(run(1).world.can_undo_reset);
}

TEST_F(LiveCycleTest, SpeedIsThatOfTheBody) {
  move(kInTheBox, 1500);
  const double before = cycle_.newest().world.bodies[0].T_base_object.translation().x();
  const WorldSnapshot& state = move(kInTheBox + Eigen::Vector3d(0.0002, 0.0, 0.0), 1);
  const Eigen::Vector3d after = state.world.bodies[0].T_base_object.translation();
  // The tolerance allows for the body's rotation, which moves its origin less than a tenth as much
  // here.
  EXPECT_NEAR(state.speeds[0], (after.x() - before) / kCycle, 0.1 * state.speeds[0] + 1e-9);
}

/// An arm beside the box, with its tip at the tool's start.
std::unique_ptr<LiveArm> an_arm(const TriangleMesh& guards = {}) {
  const RobotModel model =
      read_urdf(source_folder() / "calib/robots/irb120_like/irb120_like.urdf").value();
  SceneArm arm{.model = model,
               .T_base_robot = Pose::from_translation({-0.6, 0.0, 0.0}),
               .tip = default_tip(model),
               .q = Eigen::VectorXd::Zero(6),
               .link_meshes = link_meshes(model).value().of_link};
  arm.q << 0.0, 0.4, 0.4, 0.0, 0.7, 0.0;
  SceneWorld world;
  world.model = test::one_box_on_a_table();
  world.model.guard_mesh_base = guards;
  world.p_base_tool_start = test::kToolStart;
  return std::make_unique<LiveArm>(make_live_arm(arm, world));
}

class LiveCycleWithArmTest : public testing::Test {
 protected:
  DeviceSample sample_{test::kToolStart, Eigen::Quaterniond::Identity(), true, true};
  LiveCycle cycle_{test::a_box_on_a_table(), std::make_unique<ScriptedDevice>(sample_),
                   test::options_with_tool_start(), an_arm()};
};

TEST_F(LiveCycleWithArmTest, TheTipFollowsTheToolWithoutAllocating) {
  ASSERT_TRUE(cycle_.newest().arm.has_value());
  cycle_.step(kCycle);
  cycle_.publish(1e-5, 0, kCycle);
  (void)cycle_.newest();
  const long before = heap_allocations.load();
  for (int i = 0; i < 1000; ++i) {
    sample_.p_base_tip = test::kToolStart + Eigen::Vector3d(-0.02, 0.04, 0.06) * (i / 1000.0);
    cycle_.step(kCycle * i);
    cycle_.publish(1e-5, 0, kCycle * i);
    (void)cycle_.newest();
  }
  EXPECT_EQ(heap_allocations.load() - before, 0);
  const ArmState& arm = *cycle_.newest().arm;
  EXPECT_TRUE(arm.is_reached);
  EXPECT_FALSE(arm.is_stopped);
}

/// A level sheet, 4 m wide.
TriangleMesh a_sheet(float height) {
  return {{{-2, -2, height}, {2, -2, height}, {2, 2, height}, {-2, 2, height}},
          {},
          {},
          {{0, 1, 2}, {0, 2, 3}}};
}

TEST_F(LiveCycleWithArmTest, ALinkIsStoppedBeforeAGuard) {
  // 19 mm from a link at the start; the tool is moved up.
  std::unique_ptr<LiveArm> guarded = an_arm(a_sheet(0.54F));
  const std::optional<NearestPair> at_start = guarded->follower.state().nearest;
  ASSERT_TRUE(at_start && at_start->surface);
  EXPECT_EQ(*at_start->surface, guarded->has_scan ? 2U : 1U);
  LiveCycle cycle{test::a_box_on_a_table(), std::make_unique<ScriptedDevice>(sample_),
                  test::options_with_tool_start(), std::move(guarded)};
  double nearest = 1.0;
  bool is_stopped = false;
  for (int i = 0; i < 1000; ++i) {
    sample_.p_base_tip = test::kToolStart + Eigen::Vector3d(0.0, 0.0, 0.3) * (i / 1000.0);
    cycle.step(kCycle * i);
    cycle.publish(1e-5, 0, kCycle * i);
    const ArmState& arm = *cycle.newest().arm;
    if (arm.nearest) nearest = std::min(nearest, arm.nearest->distance);
    is_stopped = is_stopped || arm.is_stopped;
  }
  EXPECT_TRUE(is_stopped);
  EXPECT_GT(nearest, 0.0);
}

/// The same arm, moved by torques.
std::unique_ptr<LiveArm> a_driven_arm() {
  std::unique_ptr<LiveArm> live = an_arm();
  const RobotModel model =
      read_urdf(source_folder() / "calib/robots/irb120_like/irb120_like.urdf").value();
  JointFit joint;
  joint.sign.smoothing_speed = 0.02;
  joint.friction = {{.term = FrictionTerm::coulomb, .value = 1.0},
                    {.term = FrictionTerm::viscous, .value = 1.0}};
  drive_by_torques(*live, model, std::vector<JointFit>(6, joint));
  return live;
}

class LiveCycleWithDrivenArmTest : public testing::Test {
 protected:
  /// Moves the hand in a straight line for `cycles`.
  const WorldSnapshot& move(const Eigen::Vector3d& to, int cycles) {
    const Eigen::Vector3d from = sample_.p_base_tip;
    for (int i = 1; i <= cycles; ++i) {
      sample_.p_base_tip = from + (to - from) * (static_cast<double>(i) / cycles);
      t_ += kCycle;
      cycle_.step(t_);
    }
    cycle_.publish(1e-5, 0, t_);
    return cycle_.newest();
  }

  DeviceSample sample_{test::kToolStart, Eigen::Quaterniond::Identity(), true, true};
  LiveCycle cycle_{test::a_box_on_a_table(), std::make_unique<ScriptedDevice>(sample_),
                   test::options_with_tool_start(), a_driven_arm()};
  double t_ = 0.0;
};

TEST_F(LiveCycleWithDrivenArmTest, TheArmsTipIsTheToolAndLagsBehindTheHand) {
  const Eigen::Vector3d aside = test::kToolStart + Eigen::Vector3d(-0.02, 0.06, 0.05);
  const WorldSnapshot& moving = move(aside, 150);
  const double lag = (moving.world.p_base_hip - aside).norm();
  EXPECT_GT(lag, 2e-4);
  const long before = heap_allocations.load();
  const WorldSnapshot& settled = move(aside, 1500);
  EXPECT_EQ(heap_allocations.load() - before, 0);
  EXPECT_LT((settled.world.p_base_hip - aside).norm(), 5e-4);
  EXPECT_TRUE(settled.world.force_base.isZero(0.0));
}

TEST_F(LiveCycleTest, NeverAllocates) {
  run(10);
  const long before = heap_allocations.load();
  sample_.is_engaged = true;
  for (int i = 0; i < 3000; ++i) {
    sample_.p_base_tip.x() += 0.0001;
    t_ += kCycle;
    cycle_.step(t_);
    cycle_.publish(1e-5, 0, t_);
    if (i == 1000) cycle_.hold(true);
    if (i == 1200) cycle_.hold(false);
    if (i == 2500) cycle_.reset();
    (void)cycle_.newest();
  }
  EXPECT_EQ(heap_allocations.load() - before, 0);
}

}  // namespace
}  // namespace pcavr
