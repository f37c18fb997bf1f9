// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

using test::foam_physics;
using test::one_box;
using test::touching_tip;

PredictedWorld world_of(const WorldModel& model) { return PredictedWorld::create(model).value(); }

/// At `speed` into the box from where it is touched.
auto push(double speed, double y = 0.0) {
  return [=](double t) -> Eigen::Vector3d {
    return touching_tip(y) + Eigen::Vector3d(speed * t, 0.0, 0.0);
  };
}

TEST(OneBody, YieldsByTheContactLawWhileItIsHeld) {
  PredictedWorld world = world_of(one_box());
  // 9.57 N need 1.2 mm: at 1 mm/s, after 1 s, it holds.
  test::run(world, push(0.001), 1.0, 0.001);
  const BodyState& state = world.state()[0];
  const double expected = 8000.0 * 0.001 + 30.0 * 0.001;
  EXPECT_NEAR(state.tool_force_base.x(), expected, 1e-3);  // the mesh is in single precision
  EXPECT_NEAR(state.penetration, 0.001, 1e-8);
  EXPECT_EQ(state.planar.position, Eigen::Vector2d::Zero());
  EXPECT_EQ(state.phase, MotionPhase::held);
}

TEST(OneBody, BreaksLooseAtTheLimitingForce) {
  PredictedWorld world = world_of(one_box());
  double largest = 0.0;
  double held_until = 0.0;
  test::run(world, push(0.001), 1.5, 0.001, [&](double t) {
    if (world.state()[0].planar.position.isZero(0.0)) {
      held_until = t;
      largest = world.state()[0].tool_force_base.x();
    }
  });
  EXPECT_NEAR(largest, 9.57, 0.01);
  EXPECT_NEAR(held_until, (9.57 - 0.03) / 8.0, 0.002);
  EXPECT_GT(world.state()[0].planar.position.x(), 1e-4);
}

TEST(OneBody, SlidesAtTheCoulombForceAndStopsWithTheTip) {
  PredictedWorld world = world_of(one_box());
  test::run(world, push(0.04), 1.5, 0.001);
  EXPECT_NEAR(world.state()[0].tool_force_base.x(), 8.5, 0.01);
  EXPECT_NEAR(world.state()[0].planar.twist.x(), 0.04, 1e-4);
  EXPECT_EQ(world.state()[0].phase, MotionPhase::sliding);
  const auto stop = [](double) -> Eigen::Vector3d {
    return touching_tip() + Eigen::Vector3d(0.06, 0.0, 0.0);
  };
  test::run(world, stop, 0.5, 0.001);
  EXPECT_TRUE(world.state()[0].planar.twist.isZero(0.0));
  EXPECT_NE(world.state()[0].phase, MotionPhase::sliding);
  EXPECT_NEAR(world.state()[0].planar.position.y(), 0.0, 1e-6);
  EXPECT_NEAR(world.state()[0].planar.yaw, 0.0, 1e-5);
}

/// Press, push with a modulation, stop, reverse off it, come again.
Eigen::Vector3d busy_path(double t) {
  const double forward = t < 1.0   ? 0.05 * t + 0.003 * std::sin(2.0 * std::numbers::pi * 2.0 * t)
                         : t < 1.5 ? 0.05
                         : t < 1.7 ? 0.05 - 0.1 * (t - 1.5)
                                   : 0.03 + 0.08 * (t - 1.7);
  return touching_tip(0.01) + Eigen::Vector3d(forward, 0.0, 0.0);
}

struct Variant {
  const char* name;
  double mass;
  Compliance contact;
};

class StepSize : public testing::TestWithParam<Variant> {};

TEST_P(StepSize, DoesNotChangeAPushByATenthOfAMillimetre) {
  BodyPhysics physics = foam_physics();
  physics.friction.coulomb_force *= GetParam().mass / physics.friction.mass;
  physics.friction.limiting_force *= GetParam().mass / physics.friction.mass;
  physics.friction.mass = GetParam().mass;
  physics.contact = GetParam().contact;
  std::vector<std::vector<PlanarState>> tracks;
  for (const double dt : {0.0005, 0.001, 0.002}) {
    PredictedWorld world = world_of(one_box(physics));
    std::vector<PlanarState>& track = tracks.emplace_back();
    long step = 0;
    // The path is sampled at 2 ms by all, as it would be from one recording.
    const auto sampled = [](double t) -> Eigen::Vector3d {
      const double before = std::floor(t / 0.002 + 1e-6) * 0.002;
      const double share = (t - before) / 0.002;
      return (1.0 - share) * busy_path(before) + share * busy_path(before + 0.002);
    };
    test::run(world, sampled, 2.5, dt, [&](double) {
      if (++step % std::lround(0.002 / dt) == 0) track.push_back(world.state()[0].planar);
    });
  }
  double worst = 0.0;
  for (const auto& track : tracks) {
    for (std::size_t i = 0; i < track.size(); ++i) {
      worst = std::max(worst, (track[i].position - tracks[0][i].position).norm());
      worst = std::max(worst, 0.1 * std::abs(track[i].yaw - tracks[0][i].yaw));
    }
  }
  EXPECT_LT(worst, 1e-4) << GetParam().name;
}

INSTANTIATE_TEST_SUITE_P(OneBody, StepSize,
                         testing::Values(Variant{"foam", 3.0, {8000.0, 30.0, 1.0}},
                                         Variant{"soft", 3.0, {2000.0, 10.0, 1.0}},
                                         Variant{"undamped", 3.0, {6000.0, 0.0, 1.0}},
                                         Variant{"hunt", 3.0, {3e5, 3e5, 1.5}},
                                         Variant{"stiff", 0.3, {1e6, 50.0, 1.0}}),
                         [](const auto& variant) { return std::string(variant.param.name); });

}  // namespace
}  // namespace pcavr
