// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "haptics/tabletop.hpp"
#include "haptics/world_paths.hpp"

namespace pcavr {
namespace {

using test::kCycle;
using test::one_box_on_a_table;
using test::touching_tip;

constexpr int kMinute = 60'000;

/// The maximum displacement of any body from its start in a minute [m].
double max_drift_of(HapticWorld& world, const ToolCommand& command) {
  std::vector<Eigen::Vector3d> start;
  for (const HapticBodyState& body : world.state().bodies) {
    start.push_back(body.T_base_object.translation());
  }
  double max_drift = 0.0;
  for (int i = 0; i < kMinute; ++i) {
    world.step(command, kCycle);
    for (std::size_t k = 0; k < start.size(); ++k) {
      const Eigen::Vector3d& p = world.state().bodies[k].T_base_object.translation();
      max_drift = std::max(max_drift, (p - start[k]).norm());
    }
  }
  return max_drift;
}

/// Three boxes side by side against a scanned wall, on a table with 1 mm of noise.
HapticWorldModel crowded_table() {
  HapticWorldModel model = one_box_on_a_table(0.001);
  model.world.bodies = test::row_of_boxes(3, 0.0).bodies;
  test::append(model.world.static_mesh_base, test::wall_at(2.5 * 0.175, 0.001));
  return model;
}

TEST(AtRest, NothingMovesForAMinuteWithoutContact) {
  HapticWorld world = HapticWorld::create(crowded_table()).value();
  world.reset({-0.3, 0.0, 0.2});
  EXPECT_LT(max_drift_of(world, {{-0.3, 0.0, 0.2}, true}), 1e-6);
}

TEST(AtRest, NothingMovesForAMinuteAtNineTenthsOfTheStaticLimit) {
  HapticWorld world = HapticWorld::create(one_box_on_a_table(0.001)).value();
  // 9.57 N at 8 kN/m.
  const Eigen::Vector3d pressed = touching_tip() + Eigen::Vector3d(0.9 * 9.57 / 8000.0, 0.0, 0.0);
  world.reset(touching_tip());
  for (int i = 0; i <= 200; ++i) {
    world.step({touching_tip() + i / 200.0 * (pressed - touching_tip()), true}, kCycle);
  }
  EXPECT_NEAR(world.state().bodies[0].tool_force_base.x(), 0.9 * 9.57, 0.2);
  EXPECT_LT(max_drift_of(world, {pressed, true}), 1e-6);
}

TEST(AtRest, NothingMovesInARowAgainstAWallBelowTheStaticLimit) {
  HapticWorld world = HapticWorld::create(crowded_table()).value();
  const Eigen::Vector3d pressed = touching_tip() + Eigen::Vector3d(0.9 * 9.57 / 8000.0, 0.0, 0.0);
  world.reset(touching_tip());
  for (int i = 0; i <= 200; ++i) {
    world.step({touching_tip() + i / 200.0 * (pressed - touching_tip()), true}, kCycle);
  }
  EXPECT_LT(max_drift_of(world, {pressed, true}), 1e-6);
}

TEST(AtRest, ABodyReleasedWhileSlidingStopsAndStays) {
  HapticWorld world = HapticWorld::create(crowded_table()).value();
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.0, 0.15, 0.0);
  world.reset(start);
  for (int i = 0; i < 300; ++i) {
    world.step({start + Eigen::Vector3d(0.1, 0.25, 0.0) * i * kCycle, true}, kCycle);
  }
  for (int i = 0; i < 2000; ++i) world.step({start, false}, kCycle);
  EXPECT_LT(max_drift_of(world, {start, false}), 1e-6);
}

TEST(AtRest, ABodyPushedAgainstAWallDoesNotPenetrateIt) {
  HapticWorldModel model = crowded_table();
  HapticWorld world = HapticWorld::create(model).value();
  world.reset(touching_tip());
  for (int i = 0; i < 2000; ++i) {  // far through all three
    world.step({touching_tip() + Eigen::Vector3d(0.3, 0.0, 0.0) * i * kCycle, true}, kCycle);
  }
  // 1 mm of noise on the wall, and as much compliance at twice the static limit of all of them.
  EXPECT_LT(world.state().bodies[2].T_base_object.translation().x(), 0.35 + 0.003);
  EXPECT_LT(world.state().bodies[0].T_base_object.translation().x(), 0.006);
}

TEST(AtRest, ALightBodyDoesNotPenetrateAWallWhereAHeavyOneRaisesTheMaximumPush) {
  HapticWorldModel model = one_box_on_a_table(0.0);
  test::append(model.world.static_mesh_base, test::wall_at(0.5 * 0.175));
  BodyPhysics light = test::foam_physics();
  light.friction.mass = 0.3;
  light.friction.limiting_force = 1.0;
  light.friction.coulomb_force = 0.9;
  model.world.bodies[0].physics = light;
  BodyPhysics heavy = test::foam_physics();
  heavy.friction.limiting_force = 60.0;
  model.world.bodies.push_back(
      {test::box_model(test::kBoxSides, "heavy"), test::standing_at(-0.3, 0.25), heavy});
  HapticWorld world = HapticWorld::create(model).value();
  world.reset(touching_tip());
  for (int i = 0; i < 2000; ++i) {
    world.step({touching_tip() + Eigen::Vector3d(0.2, 0.0, 0.0) * i * kCycle, true}, kCycle);
    ASSERT_LT(world.state().bodies[0].T_base_object.translation().x(), 0.0003) << i;
  }
  EXPECT_GT(world.state().bodies[0].tool_force_base.x(), 60.0);
}

TEST(ClosedPaths, AtABoxOnATableArePassive) {
  for (int which = 0; which < 3; ++which) {
    HapticWorld world = HapticWorld::create(test::contact_case(which)).value();
    const test::Work work = test::over_closed_paths(world, 100, 7);
    EXPECT_GT(work.touched, 50);
    EXPECT_GE(work.min, -test::kRounding) << which;
    EXPECT_GT(work.sum, 0.0);
  }
}

}  // namespace
}  // namespace pcavr
