// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Bodies into which the tip goes by more than its radius, and tips that are set too deep.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/prediction/predictor.hpp"

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

using test::foam_physics;
using test::one_box;
using test::touching_tip;

PredictedWorld world_of(const WorldModel& model) { return PredictedWorld::create(model).value(); }

/// 9.57 N need 19 mm: twice the tip's radius.
WorldModel soft_box() {
  WorldModel model = one_box();
  model.bodies[0].physics.contact = {500.0, 5.0, 1.0};
  return model;
}

// The tip goes deeper and less deep at random, to a depth above its distance from the corner, 2 to
// 4 mm. Friction of the tip turns the force by 17 degrees at most.
TEST(SoftBody, IsPushedThroughTheFaceThatTheTipEnteredAtAnyDepth) {
  Random random(11);
  for (int path = 0; path < 20; ++path) {
    PredictedWorld world = world_of(soft_box());
    const double y = 0.5 * test::kBoxSides.y() - random.uniform(0.002, 0.004);
    Eigen::Vector3d tip = touching_tip(y);
    double max_depth = 0.0;
    double speed = 0.0;
    for (int i = 0; i < 1500; ++i) {
      if (i % 100 == 0) speed = random.uniform(-0.02, 0.06);
      const Eigen::Vector3d before = tip;
      tip.x() += 1e-3 * speed;
      world.step(before, tip, 1e-3);
      const BodyState& state = world.state()[0];
      max_depth = std::max(max_depth, state.penetration);
      if (state.tool_force_base.norm() < 0.01) continue;
      const Eigen::Vector2d force =
          Eigen::Rotation2Dd(-state.planar.yaw) * state.tool_force_base.head<2>();
      ASSERT_GT(force.normalized().x(), 0.95) << path << ' ' << i;
    }
    EXPECT_GT(max_depth, 0.01 + 0.5 * test::kBoxSides.y() - y) << path;
  }
}

TEST(SoftBody, IsMovedOutOfATipThatWasSetTooDeepAsByASlowPush) {
  // The tip is at the support's level, so that no pressure shifts.
  BodyPhysics physics = foam_physics();
  physics.friction.limiting_force = physics.friction.coulomb_force;
  physics.contact = {1e5, 2000.0, 1.0};
  for (const double y : {0.0, 0.03, -0.06, 0.08}) {
    const auto path = [&](double t) -> Eigen::Vector3d {
      return touching_tip(y, 0.001) + Eigen::Vector3d(std::min(0.005 * t, 0.015), 0.0, 0.0);
    };
    PredictedWorld pushed = world_of(one_box(physics));
    test::run(pushed, path, 3.5, 0.001);
    PredictedWorld set = world_of(one_box(physics));
    set.step(path(0.0), path(0.0), 0.001);
    set.step(path(3.5), path(3.5), 0.001);
    const PlanarState& expected = pushed.state()[0].planar;
    const PlanarState& planar = set.state()[0].planar;
    EXPECT_LT((planar.position - expected.position).norm(), 2e-4) << y;
    EXPECT_NEAR(planar.yaw, expected.yaw, 0.005) << y;
    EXPECT_NEAR(set.state()[0].penetration, 8.5 / 1e5, 1e-5) << y;
  }
}

/// Error of the prediction of a body that is much softer than assumed [m]: the mean over a push
/// beside a corner, with the body's pose `delay` [s] ago as a correction at 30 Hz.
double error_of_softer_body(double from_corner, std::optional<double> delay) {
  PredictedWorld truth = world_of(soft_box());
  const auto path = [&](double t) -> Eigen::Vector3d {
    return touching_tip(0.5 * test::kBoxSides.y() - from_corner) +
           Eigen::Vector3d(0.03 * std::min(t, 1.5), 0.0, 0.0);
  };
  Predictor predictor(world_of(one_box()), 0.0, path(0.0));
  std::vector<Pose> poses{truth.T_base_object(0)};
  double sum = 0.0;
  constexpr int kSteps = 2000;
  for (int i = 1; i <= kSteps; ++i) {
    truth.step(path(1e-3 * (i - 1)), path(1e-3 * i), 1e-3);
    poses.push_back(truth.T_base_object(0));
    predictor.step(path(1e-3 * i));
    const double t = 1e-3 * i - delay.value_or(0.0);
    if (delay && t >= 0.0 && i % 33 == 0) {
      Correction correction;
      correction.t = t;
      correction.T_base_object = poses[static_cast<std::size_t>(std::lround(t / 1e-3))];
      EXPECT_TRUE(predictor.correct(correction));
    }
    sum += (predictor.world().T_base_object(0).translation() - poses.back().translation()).norm();
  }
  return sum / kSteps;
}

// The bound has 2 % more: a slow push is not exactly how the body got there. Corrections are a half
// worse without the turning that a push off the centre causes.
TEST(SoftBody, CorrectionsOfABodyThatIsSofterThanAssumedAreNotWorseThanNone) {
  for (const double from_corner : {0.003, 0.006, 0.02, 0.04}) {
    const double without = error_of_softer_body(from_corner, {});
    for (const double delay : {0.05, 0.2}) {
      EXPECT_LT(error_of_softer_body(from_corner, delay), 1.02 * without)
          << from_corner << ' ' << delay;
    }
  }
}

}  // namespace
}  // namespace pcavr
