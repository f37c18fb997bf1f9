// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/friction/point_push.hpp"

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

using test::foam_physics;
using test::one_box;
using test::touching_tip;

PredictedWorld world_of(const WorldModel& model) { return PredictedWorld::create(model).value(); }

/// A push at `speed` into the box from first touch.
auto push(double speed, double y = 0.0) {
  return [=](double t) -> Eigen::Vector3d {
    return touching_tip(y) + Eigen::Vector3d(speed * t, 0.0, 0.0);
  };
}

TEST(OneBody, IsPenetratedByTheContactLawWhileStatic) {
  PredictedWorld world = world_of(one_box());
  // 9.57 N need 1.2 mm: at 1 mm/s, after 1 s, it is still static.
  test::run(world, push(0.001), 1.0, 0.001);
  const BodyState& state = world.state()[0];
  const double expected = 8000.0 * 0.001 + 30.0 * 0.001;
  EXPECT_NEAR(state.tool_force_base.x(), expected, 1e-3);  // the mesh is in single precision
  EXPECT_NEAR(state.penetration, 0.001, 1e-8);
  EXPECT_EQ(state.planar.position, Eigen::Vector2d::Zero());
  EXPECT_EQ(state.phase, MotionPhase::static_contact);
}

TEST(OneBody, ThatIsImmovableKeepsItsPoseAndIsPenetratedByTheContactLaw) {
  WorldModel model = one_box();
  model.bodies[0].is_movable = false;
  model.bodies[0].physics.contact = {1.5e6, 3e6, 1.5};
  PredictedWorld world = world_of(model);
  const Pose before = world.T_base_object(0);
  // The push is to 2 mm at 20 mm/s: 134 N, fourteen times the friction limit of its physics.
  test::run(world, push(0.02), 0.1, 0.001);
  const BodyState& state = world.state()[0];
  EXPECT_NEAR(state.penetration, 0.002, 1e-8);
  EXPECT_NEAR(state.tool_force_base.x(), std::pow(0.002, 1.5) * (1.5e6 + 3e6 * 0.02), 0.01);
  EXPECT_EQ(world.T_base_object(0).translation(), before.translation());
  EXPECT_EQ(state.phase, MotionPhase::static_contact);
}

TEST(OneBody, IsPenetratedAtTheTipsSpeedOnAFaceWhoseSurfaceIsOffset) {
  // A floor and a wall, whose measured surface lies 0.7 mm before its CAD face.
  WorldModel model = one_box();
  TriangleMesh& mesh = model.bodies[0].model.mesh_object;
  mesh = {};
  test::add_box(mesh, {-0.1, -0.1, -0.05}, {0.1, 0.1, 0.0});
  test::add_box(mesh, {0.05, -0.1, 0.0}, {0.1, 0.1, 0.05});
  model.bodies[0].T_base_object = Pose();
  model.bodies[0].is_movable = false;
  BodyPhysics& physics = model.bodies[0].physics;
  physics.contact = {4e6, 3e7, 1.5};
  physics.tool_friction = 0.0;
  physics.surface_offset = {-0.0007, 0.0, 0.0};
  PredictedWorld world = world_of(model);
  // The tip moves on the floor, 0.1 mm deep, towards the wall at 20 mm/s, and 0.2 mm into its
  // surface.
  const double radius = model.tool_radius, z = radius - 1e-4;
  const auto tip_at = [&](double t) {
    return Eigen::Vector3d(0.05 - radius - 0.0015 + 0.02 * t, 0.0, z);
  };
  double max_force = 0.0;
  for (int i = 0; i < 50; ++i) {
    world.step(tip_at(1e-3 * i), tip_at(1e-3 * (i + 1)), 1e-3);
    max_force = std::max(max_force, world.state()[0].tool_force_base.x());
  }
  EXPECT_NEAR(max_force, std::pow(2e-4, 1.5) * (4e6 + 3e7 * 0.02), 0.01);
}

TEST(OneBody, BreaksLooseAtTheLimitingForce) {
  PredictedWorld world = world_of(one_box());
  double max_force = 0.0;
  double static_until = 0.0;
  test::run(world, push(0.001), 1.5, 0.001, [&](double t) {
    if (world.state()[0].planar.position.isZero(0.0)) {
      static_until = t;
      max_force = world.state()[0].tool_force_base.x();
    }
  });
  EXPECT_NEAR(max_force, 9.57, 0.01);
  EXPECT_NEAR(static_until, (9.57 - 0.03) / 8.0, 0.002);
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

TEST(OneBody, DoesNotCreepInAMinuteUnderNineTenthsOfTheLimit) {
  for (const double stiffness : {2000.0, 8000.0, 1e6}) {
    BodyPhysics physics = foam_physics();
    physics.contact.stiffness = stiffness;
    PredictedWorld world = world_of(one_box(physics));
    const double depth = 0.9 * 9.57 / stiffness;
    const auto press = [=](double t) -> Eigen::Vector3d {
      const double ripple = 1.0 + 0.01 * std::sin(20.0 * t);
      return touching_tip(0.02) + Eigen::Vector3d(std::min(t, 1.0) * depth / 1.01 * ripple, 0, 0);
    };
    test::run(world, press, 60.0, 0.002);
    EXPECT_EQ(world.state()[0].planar.position, Eigen::Vector2d::Zero()) << stiffness;
    EXPECT_EQ(world.state()[0].planar.yaw, 0.0) << stiffness;
    EXPECT_GT(world.state()[0].tool_force_base.x(), 8.3) << stiffness;
  }
}

TEST(OneBody, IsCriticalInTheBandBelowTheLimitingForce) {
  PredictedWorld world = world_of(one_box());
  double first = 0.0;
  test::run(world, push(0.001), 1.15, 0.001, [&](double) {
    const BodyState& state = world.state()[0];
    if (state.phase == MotionPhase::critical && first == 0.0) first = state.tool_force_base.x();
  });
  // A tenth of F_M is more than its STD of 0.5 N.
  EXPECT_NEAR(first, 0.9 * 9.57, 0.02);
  EXPECT_EQ(world.state()[0].phase, MotionPhase::critical);
}

TEST(OneBody, IsFreeAndWithoutForceAfterTheTipRetracts) {
  PredictedWorld world = world_of(one_box());
  test::run(world, push(0.04), 1.0, 0.001);
  const auto away = [](double t) -> Eigen::Vector3d {
    return touching_tip() + Eigen::Vector3d(0.04 - 0.1 * t, 0.0, 0.0);
  };
  double max_pull = 0.0;
  test::run(world, away, 1.0, 0.001,
            [&](double) { max_pull = std::min(max_pull, world.state()[0].tool_force_base.x()); });
  const BodyState& state = world.state()[0];
  EXPECT_EQ(max_pull, 0.0);
  EXPECT_EQ(state.phase, MotionPhase::free);
  EXPECT_TRUE(state.tool_force_base.isZero(0.0));
  EXPECT_TRUE(state.planar.twist.isZero(0.0));
  EXPECT_NEAR(state.penetration, -0.05, 1e-12);  // the maximum that is computed
}

TEST(OneBody, KnowsItsClearanceAsSoonAsTheTipComesNear) {
  PredictedWorld world = world_of(one_box());
  const Eigen::Vector3d touching = touching_tip(0.0);
  const Eigen::Vector3d far = touching - Eigen::Vector3d(0.5, 0.0, 0.0);
  for (int i = 0; i < 3; ++i) world.step(far, far, 0.001);
  EXPECT_EQ(world.state()[0].penetration, -0.05);
  EXPECT_EQ(world.state()[0].phase, MotionPhase::free);
  const Eigen::Vector3d near = touching - Eigen::Vector3d(0.02, 0.0, 0.0);
  world.step(far, near, 0.001);
  EXPECT_NEAR(world.state()[0].penetration, -0.02, 1e-7);
  world.step(far, far, 0.001);
  EXPECT_EQ(world.state()[0].penetration, -0.05);
}

TEST(OneBody, CoastsToAStopByFriction) {
  PredictedWorld world = world_of(one_box());
  std::vector<BodyState> state = world.state();
  state[0].planar.twist = {0.3, 0.4, 0.0};
  world.set_state(state);
  const Eigen::Vector3d far(5.0, 5.0, 1.0);
  test::run(
      world, [&](double) { return far; }, 1.0, 0.001);
  // v^2 M / (2 mu M g)
  EXPECT_NEAR(world.state()[0].planar.position.norm(), 0.25 * 3.0 / (2.0 * 8.5), 1e-5);
  EXPECT_EQ(world.state()[0].phase, MotionPhase::free);
}

TEST(OneBody, CoastsLessFarWhereFrictionRisesAtLowSpeed) {
  BodyPhysics physics = foam_physics();
  physics.friction.limiting_force = 17.0;
  physics.stribeck_speed = 0.05;
  PredictedWorld world = world_of(one_box(physics));
  std::vector<BodyState> state = world.state();
  state[0].planar.twist = {0.06, 0.08, 0.0};
  world.set_state(state);
  const Eigen::Vector3d far(5.0, 5.0, 1.0);
  test::run(
      world, [&](double) { return far; }, 0.1, 2e-4);
  // The integral of M v / F(v).
  double expected = 0.0;
  constexpr double kStep = 1e-5;  // [m/s]
  for (double v = 0.5 * kStep; v < 0.1; v += kStep) {
    expected += kStep * 3.0 * v / (8.5 + (17.0 - 8.5) * std::exp(-v * v / (0.05 * 0.05)));
  }
  EXPECT_NEAR(world.state()[0].planar.position.norm(), expected, 0.005 * expected);
  EXPECT_LT(expected, 0.9 * 0.01 * 3.0 / (2.0 * 8.5));
}

/// Forces [N] under a tip at 4 mm/s, from a second after the breakaway on.
std::pair<double, double> range_of_slow_push(double stribeck_speed) {
  BodyPhysics physics = foam_physics();
  physics.contact.damping = 100.0;
  physics.stribeck_speed = stribeck_speed;
  PredictedWorld world = world_of(one_box(physics));
  std::pair<double, double> range(1e3, 0.0);
  test::run(world, push(0.004), 2.5, 0.001, [&](double t) {
    if (t < 1.3) return;
    range.first = std::min(range.first, world.state()[0].tool_force_base.x());
    range.second = std::max(range.second, world.state()[0].tool_force_base.x());
  });
  return range;
}

TEST(OneBody, SticksAndSlipsUnderASlowTipWhereFrictionFallsWithSpeed) {
  const auto [coulomb_min, coulomb_max] = range_of_slow_push(0.0);
  EXPECT_GT(coulomb_min, 8.4);
  const auto [min, max] = range_of_slow_push(0.005);
  EXPECT_GT(max, 9.57);  // it is static again and again
  EXPECT_LT(min, 8.3);
}

TEST(OneBody, HasMoreFrictionWhenPressedFromAbove) {
  PredictedWorld world = world_of(one_box());
  // 20 N down in the middle of the top, then dragged along: the tip slips at 0.3 of 20 N = 6 N.
  const auto drag = [](double t) -> Eigen::Vector3d {
    const double down = std::min(t, 0.5) * 2.0 * 20.0 / 8000.0;
    return {std::max(0.0, t - 0.6) * 0.02, 0.0, 0.125 + test::kTipRadius - down};
  };
  test::run(world, drag, 1.5, 0.001);
  EXPECT_NEAR(world.state()[0].tool_force_base.z(), -20.0, 0.1);
  EXPECT_NEAR(world.state()[0].tool_force_base.x(), 6.0, 0.05);
  EXPECT_TRUE(world.state()[0].planar.position.isZero(0.0));
  // A tip that does not slip moves it, against the friction of weight and normal force.
  BodyPhysics high_friction = foam_physics();
  high_friction.tool_friction = 2.0;
  high_friction.contact.damping = 500.0;
  PredictedWorld dragged = world_of(one_box(high_friction));
  test::run(dragged, drag, 2.5, 0.001);
  const double expected = 8.5 * (1.0 + 20.0 / (3.0 * 9.80665));
  EXPECT_NEAR(dragged.state()[0].tool_force_base.x(), expected, 0.3);
  EXPECT_GT(dragged.state()[0].planar.position.x(), 0.03);
}

TEST(OneBody, RotatesUnderAnOffCentrePushAsInTheQuasiStaticModel) {
  // Slow, so that inertia is small; at the support's level, so that no pressure shifts.
  BodyPhysics physics = foam_physics();
  physics.friction.limiting_force = physics.friction.coulomb_force;
  physics.contact = {1e5, 2000.0, 1.0};
  for (const double offset : {-0.06, 0.02, 0.05}) {
    PredictedWorld world = world_of(one_box(physics));
    const auto path = [&](double t) -> Eigen::Vector3d {
      return touching_tip(offset, 0.001) + Eigen::Vector3d(0.01 * t, 0.0, 0.0);
    };
    test::run(world, path, 0.6, 0.001);
    const PlanarState& planar = world.state()[0].planar;
    PointPush at;
    at.point = {-0.0875, offset};
    at.friction_coefficient = physics.tool_friction;
    at.velocity = {0.01, 0.0};
    const LimitSurface surface = ellipsoid_surface(8.5, 8.5 * physics.friction_radius);
    const PushMotion expected = push_at_point(surface, at);
    EXPECT_LT(twist_angle(planar.twist, expected.twist, 0.06), 0.1) << offset;
    EXPECT_NEAR(planar.twist.norm() / expected.twist.norm(), 1.0, 0.1) << offset;
  }
}

/// The mean distance of a square's pressure from its centre, over that of even pressure: the
/// pressure grows linearly, so that its centre lies at `ahead` of half a side.
double radius_share_of_square(double ahead) {
  constexpr int kCells = 200;
  double moved = 0.0, even = 0.0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const double x = (2.0 * i + 1.0) / kCells - 1.0, y = (2.0 * j + 1.0) / kCells - 1.0;
      moved += (1.0 + 3.0 * ahead * x) * std::hypot(x - ahead, y);
      even += std::hypot(x, y);
    }
  }
  return moved / even;
}

TEST(OneBody, TurnsMoreUnderAPushThatMovesItsPressureAhead) {
  BodyPhysics physics = foam_physics();
  physics.friction.limiting_force = physics.friction.coulomb_force;
  physics.contact = {1e5, 2000.0, 1.0};
  physics.tool_friction = 0.0;
  double even = 0.0;
  for (const double height : {0.001, 0.06, 0.09}) {
    PredictedWorld world = world_of(one_box(physics));
    const auto path = [&](double t) -> Eigen::Vector3d {
      return touching_tip(0.025, height) + Eigen::Vector3d(0.01 * t, 0.0, 0.0);
    };
    test::run(world, path, 0.3, 0.001);
    const BodyState& state = world.state()[0];
    const double turned = state.planar.twist.z() / state.planar.twist.x();
    if (even == 0.0) even = turned;
    // An ellipsoid turns by the force's arm over the square of its radius.
    const double ahead = height * state.tool_force_base.x() / (physics.friction.mass * 9.80665);
    const double share = radius_share_of_square(ahead / 0.0875);
    EXPECT_NEAR(turned / even, 1.0 / (share * share), 0.05) << height;  // as if it were round
  }
  EXPECT_LT(radius_share_of_square(0.27), 0.94);
}

TEST(OneBody, StaysFiniteForAnyMotionOfTheTip) {
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {
    BodyPhysics physics = foam_physics();
    physics.friction.mass = std::exp(random.uniform(-3.0, 2.0));
    physics.friction.coulomb_force = physics.friction.mass * random.uniform(0.0, 8.0);
    physics.friction.limiting_force = physics.friction.coulomb_force * random.uniform(0.5, 1.5);
    physics.contact.stiffness = std::exp(random.uniform(6.0, 14.5));
    physics.contact.damping = random.uniform() < 0.3 ? 0.0 : random.uniform(0.0, 1000.0);
    physics.contact.exponent = random.uniform() < 0.5 ? 1.0 : random.uniform(1.0, 2.0);
    PredictedWorld world = world_of(one_box(physics));
    Eigen::Vector3d tip = touching_tip();
    double max_speed = 0.0;
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector3d before = tip;
      const double kind = random.uniform();
      const double size = kind < 0.9 ? 0.002 : kind < 0.99 ? 0.02 : 1.0;
      tip += Eigen::Vector3d(random.uniform(-size, size), random.uniform(-size, size),
                             0.3 * random.uniform(-size, size));
      if (random.uniform() < 0.02) tip = touching_tip(0.0, 0.03) + Eigen::Vector3d(0.02, 0.0, 0.0);
      world.step(before, tip, random.uniform(0.0005, 0.002));
      const BodyState& state = world.state()[0];
      max_speed = std::max(max_speed, state.planar.twist.head<2>().norm());
      ASSERT_TRUE(state.planar.position.allFinite() && std::isfinite(state.planar.yaw));
      ASSERT_TRUE(state.tool_force_base.allFinite() && std::isfinite(state.penetration));
      ASSERT_LE(state.tool_force_base.norm(), 2000.0 * 1.05);
    }
    EXPECT_LT(max_speed, 50.0);
  }
}

TEST(OneBody, IgnoresAnInvalidTipPosition) {
  PredictedWorld world = world_of(one_box());
  test::run(world, push(0.04), 0.5, 0.001);
  const PlanarState before = world.state()[0].planar;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  world.step({nan, 0.0, 0.0}, touching_tip(), 0.001);
  world.step(touching_tip(), {infinite, 0.0, 0.0}, 0.001);
  world.step(touching_tip(), touching_tip(), nan);
  world.step(touching_tip(), touching_tip(), -1.0);
  EXPECT_EQ(world.state()[0].planar.position, before.position);
}

TEST(OneBody, SlidesToRestWithoutATool) {
  PredictedWorld world = world_of(one_box());
  std::vector<BodyState> state = world.state();
  state[0].planar.twist.x() = 0.3;
  world.set_state(state);
  PredictedWorld other = world_of(one_box());
  other.set_state(state);
  const Eigen::Vector3d far(5.0, 0.0, 0.0);
  for (int i = 0; i < 400; ++i) {
    world.step(0.001);
    other.step(far, far, 0.001);
  }
  EXPECT_TRUE(world.state()[0].planar.twist.isZero(0.0));
  EXPECT_GT(world.state()[0].planar.position.x(), 0.01);
  EXPECT_EQ(world.state()[0].planar.position, other.state()[0].planar.position) << "a tool far off";
}

/// Press, push with a modulation, stop, retract, push again.
Eigen::Vector3d varied_path(double t) {
  const double forward = t < 1.0   ? 0.05 * t + 0.003 * std::sin(2.0 * std::numbers::pi * 2.0 * t)
                         : t < 1.5 ? 0.05
                         : t < 1.7 ? 0.05 - 0.1 * (t - 1.5)
                                   : 0.03 + 0.08 * (t - 1.7);
  return touching_tip(0.01) + Eigen::Vector3d(forward, 0.0, 0.0);
}

struct Variant {
  const char* name;
  double mass;
  HuntCrossley contact;
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
      return (1.0 - share) * varied_path(before) + share * varied_path(before + 0.002);
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
