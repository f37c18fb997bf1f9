// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

#include "haptics/tabletop.hpp"
#include "haptics/world_checker.hpp"

namespace pcavr {
namespace {

using test::kCycle;
using test::one_box_on_a_table;
using test::touching_tip;

constexpr double kHalfBox = 0.5 * 0.175;   // [m]
constexpr double kSinglePrecision = 1e-8;  // [m] of the meshes' corners, near 0.1

HapticWorld world_of(const HapticWorldModel& model) { return HapticWorld::create(model).value(); }

/// Steps with the hand engaged from where it was to `to`, at `speed` [m/s].
template <typename After>
Eigen::Vector3d move(HapticWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                     double speed, const After& after) {
  const auto steps = static_cast<int>(std::ceil((to - from).norm() / (speed * kCycle)));
  for (int i = 1; i <= steps; ++i) {
    world.step({from + (static_cast<double>(i) / steps) * (to - from), true}, kCycle);
    after();
  }
  return to;
}
Eigen::Vector3d move(HapticWorld& world, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                     double speed) {
  return move(world, from, to, speed, [] {});
}

TEST(HapticWorld, PushesABodyThatTheVisibleToolDoesNotEnter) {
  HapticWorld world = world_of(one_box_on_a_table());
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.02, 0.0, 0.0);
  world.reset(start);
  const auto face = [&] {
    return world.state().bodies[0].T_base_object.translation().x() - kHalfBox;
  };
  move(world, start, start + Eigen::Vector3d(0.12, 0.0, 0.0), 0.04, [&] {
    const HapticWorldState& state = world.state();
    ASSERT_LE(state.p_base_proxy.x(), face() - 0.01 + kSinglePrecision);
    ASSERT_LE(state.force_base.norm(), 5.0 + 1e-12);
  });
  const HapticWorldState& state = world.state();
  EXPECT_EQ(state.touched_body, 0U);
  EXPECT_FALSE(state.touches_scan);
  EXPECT_EQ(state.bodies[0].phase, MotionPhase::sliding);
  // The HIP penetrates as the sliding friction needs: 8.5 N at 8 kN/m.
  EXPECT_NEAR(state.p_base_hip.x() + 0.01 - face(), 8.5 / 8000.0, 5e-5);
  EXPECT_NEAR(state.bodies[0].tool_force_base.x(), 8.5, 0.1);
  EXPECT_NEAR(state.force_base.x(), -5.0, 1e-9);
}

TEST(HapticWorld, RendersTheBodysReactionForce) {
  HapticWorldModel model = one_box_on_a_table();
  model.force.max_force = 50.0;
  HapticWorld world = world_of(model);
  world.reset(touching_tip());
  // 0.5 mm deep: 4 N, less than the box's static limit.
  move(world, touching_tip(), touching_tip() + Eigen::Vector3d(0.0005, 0.0, 0.0), 0.01);
  EXPECT_NEAR(world.state().force_base.x(), -4.0, 0.3);
  for (int i = 0; i < 5; ++i) {
    world.step({touching_tip() + Eigen::Vector3d(0.0005, 0.0, 0.0), true}, kCycle);
  }
  EXPECT_NEAR(world.state().force_base.x(), -4.0, 1e-3);
  EXPECT_EQ(world.state().bodies[0].phase, MotionPhase::static_contact);
}

TEST(HapticWorld, RendersAnImmovableBodyByItsOwnLaw) {
  HapticWorldModel model = one_box_on_a_table();
  model.force.max_force = 200.0;
  model.world.bodies[0].is_movable = false;
  model.world.bodies[0].physics.contact = {1e6, 2e6, 1.5};
  HapticWorld world = world_of(model);
  world.reset(touching_tip());
  const Eigen::Vector3d deep = touching_tip() + Eigen::Vector3d(0.002, 0.0, 0.0);
  move(world, touching_tip(), deep, 0.01);
  for (int i = 0; i < 20; ++i) world.step({deep, true}, kCycle);
  const double expected = 1e6 * std::pow(0.002, 1.5);  // 89 N; the friction limit is 9.6 N
  EXPECT_NEAR(-world.state().force_base.x(), expected, 0.01 * expected);
  EXPECT_EQ(world.state().touched_body, 0);
  EXPECT_FALSE(world.state().touches_scan);
  EXPECT_EQ(world.state().bodies[0].T_base_object.translation(),
            model.world.bodies[0].T_base_object.translation());
}

TEST(HapticWorld, PushesAlongTheTableThatTheHandPressesInto) {
  HapticWorld world = world_of(one_box_on_a_table(0.0005));
  const Eigen::Vector3d above(-0.12, 0.0, 0.02);
  world.reset(above);
  const Eigen::Vector3d below = move(world, above, {-0.12, 0.0, 0.005}, 0.05);
  move(world, below, below + Eigen::Vector3d(0.06, 0.0, 0.0), 0.05);
  const HapticWorldState& state = world.state();
  EXPECT_TRUE(state.touches_scan);
  EXPECT_EQ(state.touched_body, 0U);
  EXPECT_GT(state.bodies[0].T_base_object.translation().x(), 0.03);
  EXPECT_GE(state.p_base_proxy.z(), 0.01 - 1e-9);
  EXPECT_GT(state.force_base.z(), 0.0);
  EXPECT_LT(state.force_base.x(), 0.0);
}

TEST(HapticWorld, PushesNothingAndResetsTheHipToTheProxyWhenNotEngaged) {
  HapticWorld world = world_of(one_box_on_a_table());
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.002, 0.0, 0.0);
  world.reset(start);
  const Eigen::Vector3d tip = move(world, start, start + Eigen::Vector3d(0.004, 0.0, 0.0), 0.04);
  double before = world.state().force_base.norm();
  EXPECT_GT(before, 4.0);
  for (int i = 0; i < 10; ++i) {
    world.step({tip, false}, kCycle);
    EXPECT_FALSE(world.state().is_engaged);
    EXPECT_GE(world.state().force_base.norm(), before - 2000.0 * kCycle - 1e-12);
    EXPECT_EQ(world.state().p_base_hip, world.state().p_base_proxy);
    EXPECT_EQ(world.state().bodies[0].tool_force_base, Eigen::Vector3d::Zero());
    before = world.state().force_base.norm();
  }
  EXPECT_EQ(before, 0.0);
  EXPECT_FALSE(world.state().touched_body.has_value());
}

TEST(HapticWorld, TreatsAnInvalidTipAsNotEngaged) {
  HapticWorld world = world_of(one_box_on_a_table());
  world.reset(touching_tip());
  for (const double invalid :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d tip = touching_tip();
      tip[axis] = invalid;
      world.step({tip, true}, kCycle);
      EXPECT_FALSE(world.state().is_engaged);
      EXPECT_EQ(world.state().p_base_proxy, touching_tip());
      world.reset(tip);
      EXPECT_TRUE(world.state().p_base_proxy.allFinite());
      world.reset(touching_tip());
    }
  }
}

TEST(HapticWorld, PutsTheToolAboveAnObstacle) {
  HapticWorld world = world_of(one_box_on_a_table());
  world.reset({0.0, 0.0, 0.06});  // in the middle of the box, farther than a radius from its faces
  EXPECT_GE(world.state().p_base_proxy.z(), 0.125 + 0.01 - kSinglePrecision);
  EXPECT_LE(world.state().p_base_proxy.z(), 0.125 + 0.015);
  EXPECT_EQ(world.state().p_base_proxy.head<2>(), Eigen::Vector2d::Zero());
  world.reset({-0.3, 0.0, 0.003});
  EXPECT_GE(world.state().p_base_proxy.z(), 0.01 - kSinglePrecision);
  world.reset({-0.3, 0.0, 0.3});
  EXPECT_EQ(world.state().p_base_proxy, Eigen::Vector3d(-0.3, 0.0, 0.3));
}

TEST(HapticWorld, ResetRestoresTheInitialState) {
  HapticWorld world = world_of(one_box_on_a_table());
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.01, 0.0, 0.0);
  const auto run = [&] {
    world.reset(start);
    move(world, start, start + Eigen::Vector3d(0.06, 0.01, 0.0), 0.1);
    return world.state();
  };
  const HapticWorldState first = run();
  const HapticWorldState second = run();
  EXPECT_EQ(first.force_base, second.force_base);
  EXPECT_EQ(first.bodies[0].T_base_object.translation(),
            second.bodies[0].T_base_object.translation());
  EXPECT_EQ(first.p_base_proxy, second.p_base_proxy);
}

// The hand goes on through a box that stands against a wall, and through the wall.
TEST(HapticWorld, HasNoPopThroughAtABodyThatCannotMove) {
  HapticWorldModel model = one_box_on_a_table();
  test::append(model.world.static_mesh_base, test::wall_at(kHalfBox));
  HapticWorld world = world_of(model);
  test::WorldChecker checker(model);
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.01, 0.0, 0.0);
  world.reset(start);
  const Eigen::Vector3d end = start + Eigen::Vector3d(0.4, 0.0, 0.0);
  move(world, start, end, 0.2, [&] {
    checker.check(world.state(), kCycle);
    ASSERT_LE(world.state().p_base_proxy.x(), -kHalfBox - 0.01 + 0.001);
    ASSERT_LE(world.state().bodies[0].T_base_object.translation().x(), 0.001);
  });
  EXPECT_NEAR(world.state().force_base.norm(), 5.0, 1e-9);
  move(world, end, start, 0.2, [&] { checker.check(world.state(), kCycle); });
  EXPECT_EQ(world.state().force_base, Eigen::Vector3d::Zero());
  EXPECT_EQ(checker.count().in_bodies, 0);
  EXPECT_EQ(checker.count().in_scan, 0);
  EXPECT_EQ(checker.count().jumps, 0);
  EXPECT_EQ(checker.count().body_jumps, 0);
  EXPECT_EQ(checker.count().without_force, 0);
}

TEST(HapticWorld, HasNoPopThroughWhereTheHandJumps) {
  HapticWorld world = world_of(one_box_on_a_table());
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.05, 0.0, 0.0);
  world.reset(start);
  for (int i = 0; i < 200; ++i) {
    world.step({{0.3, 0.0, 0.06}, true}, kCycle);
    const double face = world.state().bodies[0].T_base_object.translation().x() - kHalfBox;
    ASSERT_LE(world.state().p_base_proxy.x(), face - 0.01 + kSinglePrecision) << i;
  }
  EXPECT_GT(world.state().bodies[0].T_base_object.translation().x(), 0.01);
}

TEST(HapticWorld, RejectsInvalidModels) {
  HapticWorldModel model = one_box_on_a_table();
  model.options.scan_friction = -0.1;
  EXPECT_THROW((void)HapticWorld::create(model), ContractError);
  model = one_box_on_a_table();
  model.supports_base = {{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}};
  EXPECT_THROW((void)HapticWorld::create(model), ContractError);
  model = one_box_on_a_table();
  model.world.bodies[0].model.mesh_object.triangles.clear();
  EXPECT_FALSE(HapticWorld::create(model).has_value());
}

}  // namespace
}  // namespace pcavr
