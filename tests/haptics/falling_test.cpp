// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "haptics/tabletop.hpp"

namespace pcavr {
namespace {

using test::kCycle;
using test::one_box_on_a_table;
using test::touching_tip;

HapticWorld world_of(const HapticWorldModel& model) { return HapticWorld::create(model).value(); }

/// Pushes the box over the edge at x = 0.5, 40 cm from where it stands.
void push_off(HapticWorld& world, double distance) {
  const Eigen::Vector3d start = touching_tip() - Eigen::Vector3d(0.01, 0.0, 0.0);
  world.reset(start);
  for (double x = 0.0; x < distance; x += 0.2 * kCycle) {
    world.step({start + Eigen::Vector3d(x, 0.0, 0.0), true}, kCycle);
  }
}

TEST(FallingBody, StaysWhileItsCentreOfMassIsAboveTheSupport) {
  HapticWorld world = world_of(one_box_on_a_table());
  push_off(world, 0.49);
  const HapticBodyState& body = world.state().bodies[0];
  EXPECT_GT(body.T_base_object.translation().x(), 0.47);
  EXPECT_FALSE(body.is_outside_model);
  EXPECT_NEAR(body.T_base_object.translation().z(), 0.0625, 1e-9);
}

TEST(FallingBody, TipsOverTheEdgeAndFallsWithoutCollidingWithTheTool) {
  HapticWorld world = world_of(one_box_on_a_table());
  push_off(world, 0.54);
  ASSERT_TRUE(world.state().bodies[0].is_outside_model);
  const Eigen::Vector3d hand(0.5, 0.0, 0.06);
  double height = world.state().bodies[0].T_base_object.translation().z();
  for (int i = 0; i < 700; ++i) {
    world.step({hand, true}, kCycle);
    const Pose& T = world.state().bodies[0].T_base_object;
    ASSERT_TRUE(T.translation().allFinite());
    ASSERT_LE(T.translation().z(), height + 1e-12) << i;
    height = T.translation().z();
    // Its top tilts outward, over the edge.
    const Eigen::Vector3d up = T.rotation() * Eigen::Vector3d::UnitZ();
    ASSERT_TRUE(height <= 0.0 || up.x() >= 0.0) << i;
  }
  const Pose& T = world.state().bodies[0].T_base_object;
  // Free fall from rest over 0.7 s is 2.4 m; tilting over the edge took some of the time.
  EXPECT_LT(height, -0.5);
  EXPECT_GT(height, -2.5);
  EXPECT_GT(T.translation().x(), 0.5);
  EXPECT_EQ(world.state().force_base, Eigen::Vector3d::Zero());
  EXPECT_FALSE(world.state().touched_body.has_value());
  EXPECT_EQ(world.state().p_base_proxy, hand);
}

TEST(FallingBody, StopsOutOfViewAndStaysFinite) {
  HapticWorld world = world_of(one_box_on_a_table());
  push_off(world, 0.54);
  for (int i = 0; i < 60'000; ++i) world.step({{0.0, 0.0, 0.3}, false}, kCycle);
  const Pose& T = world.state().bodies[0].T_base_object;
  EXPECT_TRUE(T.translation().allFinite());
  EXPECT_LT(T.translation().z(), -4.9);
  EXPECT_GT(T.translation().z(), -5.5);
  EXPECT_TRUE(world.state().bodies[0].is_outside_model);
  world.reset({0.0, 0.0, 0.3});
  EXPECT_FALSE(world.state().bodies[0].is_outside_model);
  EXPECT_EQ(world.state().bodies[0].T_base_object.translation().head<2>(), Eigen::Vector2d::Zero());
}

TEST(FallingBody, RestsOnTheFloorThatTheScanShows) {
  HapticWorldModel model = one_box_on_a_table();
  TriangleMesh floor = test::scanned_table(0.0, 0.05, {-1.0, -1.0}, {1.5, 1.0});
  for (Eigen::Vector3f& v : floor.vertices) v.z() -= 0.7F;
  test::append(model.world.static_mesh_base, floor);
  HapticWorld world = world_of(model);
  push_off(world, 0.54);
  ASSERT_TRUE(world.state().bodies[0].is_outside_model);
  for (int i = 0; i < 3000; ++i) world.step({{0.0, 0.0, 0.3}, false}, kCycle);
  const Pose T = world.state().bodies[0].T_base_object;
  double low = 1.0;
  for (const Eigen::Vector3f& v : model.world.bodies[0].model.mesh_object.vertices) {
    low = std::min(low, (T * v.cast<double>()).z());
  }
  EXPECT_NEAR(low, -0.7, 1e-6);
  EXPECT_NEAR((T.rotation_matrix() * Eigen::Vector3d::Ones()).z() /
                  std::round((T.rotation_matrix() * Eigen::Vector3d::Ones()).z()),
              1.0, 1e-6)
      << "flat on a face";
  world.step({{0.0, 0.0, 0.3}, false}, kCycle);
  EXPECT_EQ(world.state().bodies[0].T_base_object.translation(), T.translation());
}

TEST(FallingBody, DoesNotStartForABodyWithoutASupport) {
  HapticWorldModel model = one_box_on_a_table();
  for (Eigen::Vector3d& corner : model.supports_base[0]) corner.x() += 2.0;
  HapticWorld world = world_of(model);
  push_off(world, 0.1);
  EXPECT_FALSE(world.state().bodies[0].is_outside_model);
  // A floor 0.7 m below is not its support.
  model = one_box_on_a_table();
  model.supports_base.push_back({{-3.0, -3.0, -0.7}, {3.0, -3.0, -0.7}, {3.0, 3.0, -0.7}});
  HapticWorld above_a_floor = world_of(model);
  push_off(above_a_floor, 0.54);
  EXPECT_TRUE(above_a_floor.state().bodies[0].is_outside_model);
}

TEST(FallingBody, LeavesTheOtherBodiesOnTheTable) {
  HapticWorldModel model = one_box_on_a_table();
  model.world.bodies = test::row_of_boxes(2, 0.01).bodies;
  HapticWorld world = world_of(model);
  push_off(world, 0.40);
  EXPECT_FALSE(world.state().bodies[0].is_outside_model);
  EXPECT_TRUE(world.state().bodies[1].is_outside_model);
  const double x = world.state().bodies[0].T_base_object.translation().x();
  EXPECT_NEAR(x, 0.39, 0.01);
}

}  // namespace
}  // namespace pcavr
