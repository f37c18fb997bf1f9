// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/haptic_world.hpp"

#include <gtest/gtest.h>

#include "haptics/tabletop.hpp"

namespace pcavr {
namespace {

using test::kCycle;

HapticWorld world_of(const HapticWorldModel& model) { return HapticWorld::create(model).value(); }

TEST(HapticWorld, PushesABodyThatTheVisibleToolDoesNotEnter) {
  HapticWorld world = world_of(test::one_box_on_a_table());
  const Eigen::Vector3d start = test::touching_tip() - Eigen::Vector3d(0.02, 0.0, 0.0);
  world.reset(start);
  for (int i = 1; i <= 3000; ++i) {
    const Eigen::Vector3d tip = start + Eigen::Vector3d(0.04 * kCycle * i, 0.0, 0.0);
    world.step({tip, true}, kCycle);
    const HapticWorldState& state = world.state();
    const double face = state.bodies[0].T_base_object.translation().x() - 0.5 * 0.175;
    ASSERT_LE(state.p_base_proxy.x(), face - 0.01 + 1e-8) << i;  // the mesh is in floats
    ASSERT_LE(state.force_base.norm(), 5.0 + 1e-12);
  }
  EXPECT_EQ(world.state().touched_body, 0);
  EXPECT_FALSE(world.state().touches_scan);
  // Sunk in by what the friction of sliding needs: 8.5 N at 8 kN/m.
  const double face = world.state().bodies[0].T_base_object.translation().x() - 0.5 * 0.175;
  EXPECT_NEAR(world.state().p_base_hip.x() + 0.01 - face, 8.5 / 8000.0, 5e-5);
  EXPECT_NEAR(world.state().force_base.x(), -5.0, 1e-9);
  EXPECT_NEAR(world.state().bodies[0].tool_force_base.x(), 8.5, 0.1);
}

TEST(HapticWorld, LetGoPushesNothingAndReturnsToTheProxy) {
  HapticWorld world = world_of(test::one_box_on_a_table());
  const Eigen::Vector3d start = test::touching_tip() - Eigen::Vector3d(0.002, 0.0, 0.0);
  world.reset(start);
  Eigen::Vector3d tip = start;
  for (int i = 1; i <= 100; ++i) {
    tip.x() += 0.04 * kCycle;
    world.step({tip, true}, kCycle);
  }
  EXPECT_GT(world.state().force_base.norm(), 4.0);
  double before = world.state().force_base.norm();
  for (int i = 0; i < 10; ++i) {
    world.step({tip, false}, kCycle);
    EXPECT_GE(world.state().force_base.norm(), before - 2000.0 * kCycle - 1e-12);
    EXPECT_EQ(world.state().p_base_hip, world.state().p_base_proxy);
    EXPECT_EQ(world.state().bodies[0].tool_force_base, Eigen::Vector3d::Zero());
    before = world.state().force_base.norm();
  }
  EXPECT_EQ(before, 0.0);
}

}  // namespace
}  // namespace pcavr
