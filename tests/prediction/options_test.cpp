// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/gravity.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/physics/prediction/predictor.hpp"

#include "support/option_defaults.hpp"
#include "worlds.hpp"

namespace pcavr {
namespace {

TEST(PredictionOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<PredictorOptions>();
  test::expect_documented_defaults<WorldOptions>();
  test::expect_documented_defaults<PhysicsDefaults>();
}

TEST(PredictionOptions, UnknownObjectsGetTheAssumedProperties) {
  const CadModel box = test::box_model({0.1, 0.1, 0.1});
  PhysicsDefaults defaults;
  defaults.density = 1000.0;
  defaults.sliding_coefficient = 0.2;
  defaults.static_to_kinetic_ratio = 1.5;
  defaults.tool_friction = 0.7;
  defaults.contact_exponent = 1.0;
  defaults.penetration = 2e-3;
  const BodyPhysics physics =
      complete_physics({}, box, test::standing_at(0.0, 0.0, 0.0, 0.1), kStandardGravity, defaults)
          .physics;
  const double weight = kStandardGravity;  // of one litre: 1 kg
  EXPECT_NEAR(physics.friction.mass, 1.0, 1e-6);
  EXPECT_NEAR(physics.friction.coulomb_force, 0.2 * weight, 1e-5);
  EXPECT_NEAR(physics.friction.limiting_force, 0.3 * weight, 1e-5);
  EXPECT_EQ(physics.tool_friction, 0.7);
  EXPECT_EQ(physics.contact.exponent, 1.0);
  EXPECT_NEAR(physics.contact.stiffness * 2e-3, 0.3 * weight, 1e-5);
}

TEST(PredictionOptions, RejectDefaultsThatAreNotPhysical) {
  PhysicsDefaults defaults;
  defaults.density = 0.0;
  EXPECT_THROW(
      static_cast<void>(complete_physics({}, test::box_model(test::kBoxSides),
                                         test::standing_at(0.0, 0.0), kStandardGravity, defaults)),
      ContractError);
}

/// Position of the box after the tip went 20 mm into it within one step of 1 ms: 20 m/s.
double moved_by_a_jump(double max_tip_speed, double max_contact_force) {
  WorldModel model = test::one_box();
  model.options.max_tip_speed = max_tip_speed;
  model.options.max_contact_force = max_contact_force;
  PredictedWorld world = PredictedWorld::create(model).value();
  const Eigen::Vector3d from = test::touching_tip();
  world.step(from, from + Eigen::Vector3d(0.02, 0.0, 0.0), 0.001);
  return world.state()[0].planar.position.x();
}

TEST(PredictionOptions, ATipBelowItsMaximumSpeedDoesNotPlaceTheBody) {
  // A jump places the body at the tip; a fast motion pushes it with the maximum force.
  EXPECT_NEAR(moved_by_a_jump(5.0, 2000.0), 0.02, 0.002);
  EXPECT_LT(moved_by_a_jump(50.0, 100.0), 0.001);
}

/// Position of a box that is pushed 5 mm beyond a wall of that height, 30 mm from it.
double pushed_to_a_wall(double height, const WorldOptions& options) {
  WorldModel model = test::one_box();
  test::add_box(model.static_mesh_base, {0.1175, -0.2, -0.05}, {0.2, 0.2, height});
  model.options = options;
  PredictedWorld world = PredictedWorld::create(model).value();
  const auto path = [](double t) -> Eigen::Vector3d {
    return test::touching_tip() + Eigen::Vector3d(std::min(0.04 * t, 0.05), 0.0, 0.0);
  };
  test::run(world, path, 2.0, 0.001);
  return world.state()[0].planar.position.x();
}

TEST(PredictionOptions, OnlyObstaclesAboveTheMinimumHeightStopABody) {
  WorldOptions options;
  EXPECT_GT(pushed_to_a_wall(0.004, options), 0.04);
  options.min_obstacle_height = 0.002;
  EXPECT_LT(pushed_to_a_wall(0.004, options), 0.035);
}

TEST(PredictionOptions, OverlapsAreResolvedAtTheMaximumSpeed) {
  for (const double speed : {0.05, 0.2}) {
    WorldModel model = test::row_of_boxes(2, -0.004);
    model.options.max_separation_speed = speed;
    PredictedWorld world = PredictedWorld::create(model).value();
    const Eigen::Vector3d far(5.0, 0.0, 0.0);
    std::vector<BodyState> state = world.state();
    state[0].planar.twist.x() = 1e-3;  // bodies at rest, far from the tip, are not computed
    world.set_state(state);
    double max_speed = 0.0;
    for (int i = 0; i < 200; ++i) {
      world.step(far, far, 0.001);
      max_speed = std::max(max_speed,
                           world.state()[1].planar.twist.x() - world.state()[0].planar.twist.x());
    }
    EXPECT_LT(max_speed, 1.5 * speed) << speed;
    EXPECT_GT(max_speed, 0.3 * speed) << speed;
  }
}

/// Position of the box [m] after an older correction, with at most `max_corrections` kept.
double moved_by_the_first(int max_corrections) {
  PredictorOptions options;
  options.max_corrections = max_corrections;
  const Eigen::Vector3d far(5.0, 0.0, 0.0);
  Predictor predictor(PredictedWorld::create(test::one_box()).value(), 0.0, far, options);
  for (int i = 0; i < 1000; ++i) predictor.step(far);
  Correction correction;
  correction.t = 0.5;
  correction.T_base_object = test::standing_at(0.1, 0.0);
  EXPECT_TRUE(predictor.correct(correction));
  Correction physics;  // a second one, then one before both: both have to be re-applied
  physics.t = 0.6;
  physics.physics = test::foam_physics();
  EXPECT_TRUE(predictor.correct(physics));
  correction.t = 0.2;
  correction.T_base_object = test::standing_at(0.3, 0.0);
  EXPECT_TRUE(predictor.correct(correction));
  return predictor.world().state()[0].planar.position.x();
}

TEST(PredictionOptions, CorrectionsAreReappliedUpToTheirMaximumNumber) {
  EXPECT_NEAR(moved_by_the_first(512), 0.1, 1e-6);
  EXPECT_NEAR(moved_by_the_first(1), 0.3, 1e-6);
}

TEST(PredictionOptions, AConcavityBelowTheShapeToleranceIsFilled) {
  // A small box 4 mm inside of the opening of a U of three boxes overlaps the U's hull.
  const auto is_pushed_out = [](double tolerance) {
    WorldModel model = test::one_box();
    TriangleMesh mesh;
    test::add_box(mesh, {-0.1, -0.1, 0.0}, {-0.05, 0.1, 0.1});
    test::add_box(mesh, {-0.05, 0.06, 0.0}, {0.1, 0.1, 0.1});
    test::add_box(mesh, {-0.05, -0.1, 0.0}, {0.1, -0.06, 0.1});
    model.bodies[0].model = make_cad_model(mesh, "U", "test").value();
    model.bodies[0].T_base_object = Pose();
    model.bodies.push_back({test::box_model({0.04, 0.04, 0.1}, "small"),
                            test::standing_at(0.116, 0.0, 0.0, 0.1), test::foam_physics()});
    model.options.shape_tolerance = tolerance;
    PredictedWorld world = PredictedWorld::create(model).value();
    std::vector<BodyState> state = world.state();
    state[1].planar.twist.x() = 2e-3;
    world.set_state(state);
    const Eigen::Vector3d far(5.0, 0.0, 0.0);
    for (int i = 0; i < 300; ++i) world.step(far, far, 0.001);
    return (world.state()[1].planar.position - state[1].planar.position).norm() > 0.001;
  };
  EXPECT_FALSE(is_pushed_out(0.02));
  EXPECT_TRUE(is_pushed_out(1.0));
}

}  // namespace
}  // namespace pcavr
