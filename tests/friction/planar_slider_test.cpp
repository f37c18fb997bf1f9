// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/planar_slider.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/physics/friction/patch.hpp"

#include "friction/surfaces.hpp"

namespace pcavr {
namespace {

/// A foam-faced box of 0.175 m on a square patch.
PlanarFriction box() {
  PlanarFriction friction;
  friction.mass = 3.0;
  friction.inertia = 3.0 * 2.0 * 0.175 * 0.175 / 12.0;
  friction.sliding = ellipsoid_surface(8.0, 8.0 * mean_radius_of_rectangle(0.175, 0.175));
  friction.static_to_kinetic_ratio = 9.57 / 8.0;
  friction.static_to_kinetic_std = 0.861 / 8.0;
  friction.viscous = 4.0;
  return friction;
}

double energy(const PlanarFriction& friction, const PlanarState& state) {
  return 0.5 * friction.mass * state.twist.head<2>().squaredNorm() +
         0.5 * friction.inertia * state.twist.z() * state.twist.z();
}

TEST(PlanarSlider, DoesNotCreepInAMinuteUnderNineTenthsOfTheLimit) {
  PlanarState state;
  for (int i = 0; i < 60000; ++i) state = step_planar(box(), state, {0.9 * 9.57, 0, 0}, 1e-3).state;
  EXPECT_TRUE(state.position.isZero(0.0));
  EXPECT_EQ(state.yaw, 0.0);
  EXPECT_TRUE(state.twist.isZero(0.0));
}

TEST(PlanarSlider, DecidesItsPhaseByTheLoad) {
  const PlanarFriction friction = box();
  EXPECT_EQ(step_planar(friction, {}, {8.6, 0, 0}, 1e-3).state.phase,
            FrictionPhase::static_contact);
  EXPECT_EQ(step_planar(friction, {}, {9.0, 0, 0}, 1e-3).state.phase, FrictionPhase::critical);
  EXPECT_EQ(step_planar(friction, {}, {9.6, 0, 0}, 1e-3).state.phase, FrictionPhase::sliding);
}

TEST(PlanarSlider, AlongALineAgreesWithTheExactSlider) {
  const PlanarFriction friction = box();
  for (const double dt : {0.0005, 0.001, 0.002}) {
    PlanarState planar;
    SliderState exact;
    for (int i = 0; i < static_cast<int>(1.5 / dt); ++i) {
      const double load = i * dt < 0.5 ? 12.0 : 2.0;
      planar = step_planar(friction, planar, {0.6 * load, 0.8 * load, 0.0}, dt).state;
      exact = step_slider({3.0, 9.57, 0.861, 8.0, 4.0}, exact, {load, load}, dt).state;
    }
    EXPECT_GT(exact.position, 0.1);
    EXPECT_NEAR(planar.position.norm(), exact.position, 1e-4) << dt;
    EXPECT_NEAR(planar.yaw, 0.0, 1e-12);
    EXPECT_EQ(planar.phase, FrictionPhase::static_contact);
  }
}

TEST(PlanarSlider, SpinsDownAfterItsKineticEnergyOverTheMoment) {
  PlanarFriction friction = box();
  PlanarState state;
  state.twist = {0.0, 0.0, 3.0};
  const double moment = 8.0 * mean_radius_of_rectangle(0.175, 0.175);
  const double expected = energy(friction, state) / moment;
  for (int i = 0; i < 1000; ++i) state = step_planar(friction, state, {0, 0, 0}, 1e-3).state;
  EXPECT_NEAR(state.yaw, expected, 1e-5);
  EXPECT_TRUE(state.twist.isZero(0.0));
  EXPECT_NEAR(state.position.norm(), 0.0, 1e-12);
}

/// Pushed off its centre by a force that rotates with the body; then released.
PlanarState off_centre_push(double dt) {
  const PlanarFriction friction = box();
  PlanarState state;
  for (int i = 0; i < static_cast<int>(std::lround(1.0 / dt)); ++i) {
    const double force = i * dt < 0.4 ? 11.0 : 0.0;
    const double yaw = state.yaw + 0.5 * dt * state.twist.z();  // in the middle of the step
    const Eigen::Vector2d along(std::cos(yaw), std::sin(yaw));
    state = step_planar(friction, state, {force * along.x(), force * along.y(), -0.03 * force}, dt)
                .state;
  }
  return state;
}

TEST(PlanarSlider, EndsAtTheSamePositionForHalfOneAndTwoMilliseconds) {
  const PlanarState reference = off_centre_push(2e-5);
  EXPECT_LT(reference.yaw, -0.1);
  EXPECT_GT(reference.position.norm(), 0.02);
  // 0.1 mm at half the box's width is 1 mrad.
  for (const double dt : {0.0005, 0.001, 0.002}) {
    const PlanarState state = off_centre_push(dt);
    const double error = (state.position - reference.position).norm();
    EXPECT_LT(error, 1e-4) << dt;
    EXPECT_NEAR(state.yaw, reference.yaw, 1e-3) << dt;
  }
}

TEST(PlanarSlider, IsPassiveAtAnyStepAndSurface) {
  Random random(13);
  for (int trial = 0; trial < 2000; ++trial) {
    PlanarFriction friction = box();
    friction.sliding = random_surface(random);
    friction.mass = random.uniform(0.1, 10.0);
    friction.inertia = friction.mass * random.uniform(1e-4, 0.02);
    PlanarState state;
    state.yaw = random.uniform(-3.0, 3.0);
    state.twist = random_vector(random);
    const double before = energy(friction, state);
    const double dt = std::pow(10.0, random.uniform(-4.0, 0.0));
    const PlanarStep step = step_planar(friction, state, Eigen::Vector3d::Zero(), dt);
    EXPECT_LE(energy(friction, step.state), before * (1.0 + 1e-12)) << trial;
    const Eigen::Vector2d displacement = step.state.position - state.position;
    const double work = step.friction.head<2>().dot(displacement) +
                        step.friction.z() * (step.state.yaw - state.yaw);
    EXPECT_LE(work, 1e-9) << trial;
  }
}

TEST(PlanarSlider, StartsInTheQuasiStaticDirection) {
  // The twist is along the surface's normal after a very short step from rest.
  PlanarFriction friction = box();
  friction.viscous = 0.0;
  friction.inertia = friction.mass * 0.05 * 0.05;
  friction.sliding = ellipsoid_surface(8.0, 0.4);
  PlanarState state;
  const Eigen::Vector3d load(9.6, 0.0, 0.3);
  const PlanarStep step = step_planar(friction, state, load, 1e-6);
  EXPECT_LT(twist_angle(step.state.twist, sliding_direction(friction.sliding, load), 0.05), 1e-6);
}

TEST(PlanarSlider, StaysAtRestForInvalidInput) {
  PlanarState moving;
  moving.twist = {0.1, 0.0, 0.0};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(step_planar(box(), moving, {nan, 0, 0}, 1e-3).state.twist.isZero(0.0));
  EXPECT_TRUE(step_planar(box(), moving, {1, 0, 0}, nan).state.position.isZero(0.0));
}

}  // namespace
}  // namespace pcavr
