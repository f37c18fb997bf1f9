// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <gtest/gtest.h>

#include "haptics/tabletop.hpp"
#include "haptics/world_checker.hpp"
#include "haptics/world_paths.hpp"

namespace pcavr {
namespace {

using test::kCycle;

/// Three boxes, one of them immovable, and a wall; table and wall scanned with noise.
HapticWorldModel room(double noise, double radius) {
  HapticWorldModel model = test::one_box_on_a_table(noise);
  model.world.tool_radius = radius;
  std::vector<WorldBody>& bodies = model.world.bodies;
  bodies = test::row_of_boxes(3, 0.01).bodies;
  bodies[1].T_base_object = test::standing_at(0.05, 0.2, 0.4);
  bodies[2].physics.friction.limiting_force = 1000.0;
  test::append(model.world.static_mesh_base, test::wall_at(0.47, noise));
  return model;
}

/// Random motions about the boxes, 10 s each, that follow the body that they push.
test::WorldChecker::Count wander(const HapticWorldModel& model, int hands, std::uint64_t seed) {
  HapticWorld world = HapticWorld::create(model).value();
  test::WorldChecker checker(model);
  Random random(seed);
  for (int k = 0; k < hands; ++k) {
    const test::WanderingHand hand(random);
    const std::size_t target = random.below(model.world.bodies.size());
    Eigen::Vector3d about = model.world.bodies[target].T_base_object.translation();
    about.z() = 0.0;
    double t = 0.0;
    while (hand(about, t).z() < 0.17 && t < 100.0) t += 0.01;
    world.reset(hand(about, t));
    checker.restart();
    for (int i = 0; i < 10'000; ++i) {
      t += kCycle;
      const HapticBodyState& body = world.state().bodies[target];
      const Eigen::Vector2d to = body.T_base_object.translation().head<2>();
      if (!body.is_outside_model) about.head<2>() += 0.005 * (to - about.head<2>());
      world.step({hand(about, t), true}, kCycle);
      checker.check(world.state(), kCycle);
    }
  }
  return checker.count();
}

void expect_valid(const test::WorldChecker::Count& count) {
  std::printf("%ld steps, %ld inside, %ld in a body; mean lag in free space %.2f mm\n", count.steps,
              count.inside, count.in_body,
              1e3 * count.lag / static_cast<double>(std::max(count.free, 1L)));
  EXPECT_GT(count.in_body, count.steps / 20);
  EXPECT_GT(count.inside, count.in_body);
  EXPECT_EQ(count.pop_throughs, 0);
  EXPECT_EQ(count.without_force, 0);
  EXPECT_EQ(count.jumps, 0) << count.max_jump;
  EXPECT_EQ(count.body_jumps, 0) << count.max_body_jump;
  EXPECT_EQ(count.in_scan, 0) << count.max_in_scan;
  EXPECT_EQ(count.in_bodies, 0) << count.max_in_bodies;
  EXPECT_EQ(count.over_max_force, 0);
  EXPECT_EQ(count.over_max_rate, 0);
  EXPECT_EQ(count.not_finite, 0);
}

// A million steps in all.
TEST(MillionStepsAmongBodies, HaveNoPopThroughOrOverlapOrJump) {
  expect_valid(wander(room(0.0003, 0.01), 50, 21));
}
TEST(MillionStepsAmongBodies, HaveNoneOnATableWithAMillimetreOfNoise) {
  expect_valid(wander(room(0.001, 0.01), 30, 22));
}
TEST(MillionStepsAmongBodies, HaveNoneWithASmallTool) {
  expect_valid(wander(room(0.001, 0.003), 20, 23));
}

TEST(ClosedPathsAmongBodies, ArePassiveTenThousandTimes) {
  for (int which = 0; which < 3; ++which) {
    HapticWorld world = HapticWorld::create(test::contact_case(which)).value();
    const test::Work work = test::over_closed_paths(world, 4200, 11);
    std::printf("case %d: %ld paths touched, mean work %.3g J, min %.3g J, %ld below 0\n", which,
                work.touched, work.sum / static_cast<double>(work.touched), work.min, work.active);
    EXPECT_GT(work.touched, 3333);
    EXPECT_GE(work.min, -test::kRounding);
  }
}

}  // namespace
}  // namespace pcavr
