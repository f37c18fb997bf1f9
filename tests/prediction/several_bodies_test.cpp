// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/physics/prediction/closest_surface.hpp"

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

using test::foam_physics;
using test::row_of_boxes;
using test::standing_at;
using test::touching_tip;
using test::wall_at;

PredictedWorld world_of(const WorldModel& model) { return PredictedWorld::create(model).value(); }

auto push(double speed, double y = 0.0) {
  return [=](double t) -> Eigen::Vector3d {
    return touching_tip(y) + Eigen::Vector3d(speed * t, 0.0, 0.0);
  };
}

TEST(SeveralBodies, OnePushesTheNext) {
  PredictedWorld world = world_of(row_of_boxes(2, 0.02));
  test::run(world, push(0.04), 2.0, 0.001);
  const auto& state = world.state();
  const double distance = state[1].planar.position.x() - state[0].planar.position.x();
  EXPECT_NEAR(distance, 0.175, 0.0002);
  EXPECT_NEAR(state[0].planar.twist.x(), 0.04, 0.001);
  EXPECT_NEAR(state[1].planar.twist.x(), 0.04, 0.001);
  // The tip bears the friction of both.
  EXPECT_NEAR(state[0].tool_force_base.x(), 2.0 * 8.5, 0.1);
  EXPECT_NEAR(state[0].planar.yaw, 0.0, 1e-3);
  EXPECT_NEAR(state[1].planar.yaw, 0.0, 1e-3);
}

TEST(SeveralBodies, InARowStayStaticUnderALoadThatMovesASingleOne) {
  PredictedWorld world = world_of(row_of_boxes(2, 0.0));
  // 15 N: more than the static limit of one box, less than that of two.
  const auto press = [](double t) -> Eigen::Vector3d {
    return touching_tip() + Eigen::Vector3d(std::min(t, 1.0) * 15.0 / 8000.0, 0.0, 0.0);
  };
  test::run(world, press, 3.0, 0.001);
  const BodyState early = world.state()[0];
  EXPECT_LT(early.planar.position.x(), 1e-4);
  EXPECT_NEAR(early.tool_force_base.x(), 15.0, 0.8);
  test::run(
      world, [&](double t) { return press(t + 3.0); }, 20.0, 0.001);
  EXPECT_EQ(world.state()[0].planar.position, early.planar.position);
  EXPECT_TRUE(world.state()[1].planar.twist.isZero(0.0));
}

TEST(SeveralBodies, ARowOfTenIsPushedTogether) {
  PredictedWorld world = world_of(row_of_boxes(10, 0.001));
  test::run(world, push(0.04), 2.0, 0.001);
  const auto& state = world.state();
  for (std::size_t i = 1; i < state.size(); ++i) {
    const double distance = state[i].planar.position.x() - state[i - 1].planar.position.x();
    EXPECT_GT(distance, 0.175 - 0.001) << i;
    EXPECT_LT(distance, 0.175 + 0.0002) << i;
    EXPECT_NEAR(state[i].planar.twist.x(), 0.04, 0.002) << i;
  }
  EXPECT_NEAR(state[0].tool_force_base.x(), 85.0, 2.0);
}

TEST(SeveralBodies, AnOffCentreNeighbourRotates) {
  WorldModel model = row_of_boxes(2, 0.005);
  model.bodies[1].T_base_object = standing_at(0.18, 0.12);
  PredictedWorld world = world_of(model);
  test::run(world, push(0.04), 2.5, 0.001);
  EXPECT_GT(world.state()[1].planar.yaw, 0.05);
  EXPECT_TRUE(world.state()[0].planar.position.allFinite());
}

TEST(SeveralBodies, AnAbsentBodyNeitherMovesNorTouches) {
  PredictedWorld world = world_of(row_of_boxes(2, 0.002));
  std::vector<BodyState> state = world.state();
  state[1].is_present = false;
  state[1].planar.twist.x() = 1.0;
  world.set_state(state);
  const auto path = [](double t) -> Eigen::Vector3d {
    return touching_tip() + Eigen::Vector3d(0.04 * t, 0.0, 0.0);
  };
  test::run(world, path, 2.0, 0.001);
  EXPECT_GT(world.state()[0].planar.position.x(), 0.07) << "nothing is in its way";
  EXPECT_EQ(world.state()[1].planar.position, state[1].planar.position);
}

class Wall : public testing::TestWithParam<double> {};

TEST_P(Wall, OfTheScannedMeshStopsABody) {
  WorldModel model = test::one_box();
  model.static_mesh_base = wall_at(0.0875 + 0.03, GetParam());
  PredictedWorld world = world_of(model);
  // 30 mm to the wall, and 5 mm further: 40 N.
  const auto path = [](double t) -> Eigen::Vector3d {
    return touching_tip() + Eigen::Vector3d(std::min(0.04 * t, 0.035), 0.0, 0.0);
  };
  test::run(world, path, 3.0, 0.001);
  const BodyState& state = world.state()[0];
  EXPECT_NEAR(state.planar.position.x(), 0.03, 0.0005 + 2.0 * GetParam());
  EXPECT_TRUE(state.planar.twist.isZero(0.0));
  EXPECT_NEAR(state.tool_force_base.x(), 40.0, 5.0 + 8000.0 * 2.0 * GetParam());
  EXPECT_NEAR(state.planar.yaw, 0.0, 0.01);
}
INSTANTIATE_TEST_SUITE_P(SeveralBodies, Wall, testing::Values(0.0, 0.0005));

// Masses and static limits like those of objects on a table, and larger; 1 mm of motion a step.
TEST(SeveralBodies, ABodyDoesNotReboundFromAWall) {
  for (const double static_limit : {9.57, 40.0, 1000.0}) {
    for (const double mass : {0.3, 3.0}) {
      WorldModel model = test::one_box();
      model.bodies[0].physics.friction.limiting_force = static_limit;
      model.bodies[0].physics.friction.mass = mass;
      model.static_mesh_base = wall_at(0.0875 + 0.01);
      PredictedWorld world = world_of(model);
      std::vector<BodyState> state = world.state();
      state[0].planar.twist.x() = 1.0;
      world.set_state(state);
      const Eigen::Vector3d far(5.0, 0.0, 0.0);
      for (int i = 0; i < 100; ++i) {
        world.step(far, far, 0.001);
        const PlanarState& planar = world.state()[0].planar;
        ASSERT_LE(planar.position.x(), 0.01 + 0.001) << static_limit << ' ' << mass << ' ' << i;
        ASSERT_GE(planar.twist.x(), -0.05) << static_limit << ' ' << mass << ' ' << i;
      }
    }
  }
}

// A position-controlled tip as fast as a hand, off centre: bodies, wall and tip hardly have a
// common solution.
TEST(SeveralBodies, ThatArePressedAgainstAWallDoNotJump) {
  for (const double y : {0.0, 0.03, 0.06, 0.08}) {
    WorldModel model = row_of_boxes(2, 0.002);
    model.bodies[1].T_base_object = standing_at(0.18, 0.05, 0.3);
    model.bodies[1].physics.friction.limiting_force = 40.0;
    model.static_mesh_base = wall_at(0.32, 0.001);
    PredictedWorld world = world_of(model);
    const detail::ClosestSurface surface(model.bodies[0].model.mesh_object, Pose());
    const auto path = [&](double t) -> Eigen::Vector3d {
      const double pressed = std::min(0.5 * t, 0.06 + 0.02 * std::sin(20.0 * t));
      return touching_tip(y) + Eigen::Vector3d(pressed, 0.02 * std::sin(7.0 * t), 0.0);
    };
    std::vector<BodyState> before = world.state();
    test::run(world, path, 2.0, 0.001, [&](double t) {
      for (std::size_t i = 0; i < world.size(); ++i) {
        const Eigen::Vector2d displacement =
            world.state()[i].planar.position - before[i].planar.position;
        ASSERT_LT(displacement.norm(), 0.001 * 2.0) << y << ' ' << t << ' ' << i;
      }
      const auto closest = surface.closest(world.T_base_object(0).inverse() * path(t), 0.06);
      // Off its centre, the body turns away until the tip is farther than the search.
      if (closest) {
        ASSERT_NEAR(world.state()[0].penetration, test::kTipRadius - closest->distance, 1e-9) << t;
      } else {
        ASSERT_LT(world.state()[0].penetration, 0.0) << t;
      }
      before = world.state();
    });
  }
}

TEST(SeveralBodies, TheSupportInTheMeshDoesNotStopABody) {
  WorldModel model = test::one_box();
  TriangleMesh& mesh = model.static_mesh_base;
  // A bumpy table, 3 mm up and down, and the body's own surface, which a scan took for static.
  test::add_box(mesh, {-0.5, -0.5, -0.05}, {0.5, 0.5, 0.001});
  test::add_box(mesh, {0.0, -0.05, -0.01}, {0.3, 0.05, 0.003});
  test::add_box(mesh, {-0.088, -0.088, 0.0}, {0.088, 0.088, 0.126});
  PredictedWorld with = world_of(model);
  PredictedWorld without = world_of(test::one_box());
  test::run(with, push(0.04), 1.0, 0.001);
  test::run(without, push(0.04), 1.0, 0.001);
  EXPECT_EQ(with.state()[0].planar.position, without.state()[0].planar.position);
}

/// A block with a slot of 40 mm across its middle, open towards -x.
CadModel slotted_model() {
  TriangleMesh mesh;
  test::add_box(mesh, {0.02, -0.08, -0.04}, {0.08, 0.08, 0.04});
  test::add_box(mesh, {-0.08, 0.02, -0.04}, {0.02, 0.08, 0.04});
  test::add_box(mesh, {-0.08, -0.08, -0.04}, {0.02, -0.02, 0.04});
  // Three boxes side by side share faces, not edges; good enough as one closed surface for a test.
  return make_cad_model(mesh, "slotted", "test").value();
}

TEST(SeveralBodies, ANeighbourMayStandInASlot) {
  WorldModel model;
  model.tool_radius = test::kTipRadius;
  BodyPhysics physics = foam_physics();
  model.bodies.push_back({slotted_model(), standing_at(0.0, 0.0, 0.0, 0.08), physics});
  // A bar of 30 mm inside of the slot, clear of its end by 10 mm.
  model.bodies.push_back(
      {test::box_model({0.1, 0.03, 0.08}, "bar"), standing_at(-0.04, 0.0, 0.0, 0.08), physics});
  PredictedWorld world = world_of(model);
  const PlanarState start = world.state()[0].planar;
  const auto path = [](double t) -> Eigen::Vector3d {
    return {-0.09 - test::kTipRadius + 0.04 * t, 0.0, 0.04};
  };
  test::run(world, path, 0.2, 0.001);
  EXPECT_EQ(world.state()[0].planar.position, start.position);
  EXPECT_GT(world.state()[1].planar.position.x(), -0.035);
  test::run(
      world, [&](double t) { return path(t + 0.2); }, 0.8, 0.001);
  // The bar moved the block: 40 mm less the 10 mm of clearance and the tip's penetration.
  EXPECT_NEAR(world.state()[0].planar.position.x() - start.position.x(), 0.03 - 2.0 * 8.5 / 8000.0,
              0.001);
}

TEST(SeveralBodies, AnOverlapIsResolvedWithoutAJump) {
  WorldModel model = row_of_boxes(2, 0.0);
  model.bodies[1].T_base_object = standing_at(0.165, 0.0);
  PredictedWorld world = world_of(model);
  double max_speed = 0.0;
  test::run(world, push(0.01), 2.0, 0.001, [&](double) {
    max_speed = std::max(max_speed, world.state()[1].planar.twist.head<2>().norm());
  });
  EXPECT_LT(max_speed, 0.12);
  const double distance =
      world.state()[1].planar.position.x() - world.state()[0].planar.position.x();
  EXPECT_NEAR(distance, 0.175, 0.003);
}

}  // namespace
}  // namespace pcavr
