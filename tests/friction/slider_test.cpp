// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/slider.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// Paper C's foam-faced box, with Coulomb and viscous friction in addition to its F_M.
FrictionParameters foam_box() { return {3.0, 9.57, 0.861, 8.0, 4.0}; }

SliderStep push(const FrictionParameters& parameters, const SliderState& state, double from,
                double to, double dt) {
  return step_slider(parameters, state, {from, to}, dt);
}

TEST(Slider, DoesNotCreepInAMinuteUnderNineTenthsOfTheLimit) {
  SliderState state{0.25, 0.0, FrictionPhase::static_contact};
  for (int i = 0; i < 60000; ++i) {
    const double shaking = i % 2 == 0 ? 0.9 : -0.9;
    state = push(foam_box(), state, 9.57 * 0.9, 9.57 * shaking, 1e-3).state;
  }
  EXPECT_EQ(state.position, 0.25);
  EXPECT_EQ(state.velocity, 0.0);
}

TEST(Slider, DecidesItsPhaseByTheForce) {
  const FrictionParameters box = foam_box();
  EXPECT_EQ(push(box, {}, 0.0, 8.70, 1e-3).state.phase, FrictionPhase::static_contact);
  EXPECT_EQ(push(box, {}, 0.0, 8.72, 1e-3).state.phase, FrictionPhase::critical);
  EXPECT_EQ(push(box, {}, 0.0, -9.56, 1e-3).state.phase, FrictionPhase::critical);
  EXPECT_EQ(push(box, {}, 0.0, 9.60, 1e-3).state.phase, FrictionPhase::sliding);
}

TEST(Slider, AtRestBalancesTheLoad) {
  EXPECT_EQ(push(foam_box(), {}, 1.0, 5.5, 1e-3).friction, -5.5);
  EXPECT_EQ(push(foam_box(), {}, -1.0, -5.5, 1e-3).friction, 5.5);
}

TEST(Slider, SlidesAgainstCoulombAndViscousFriction) {
  const SliderStep step = push(foam_box(), {0.0, 0.2, FrictionPhase::sliding}, 8.8, 8.8, 1e-3);
  EXPECT_NEAR(step.state.velocity, 0.2, 1e-12);  // 8 N + 4 N s/m * 0.2 m/s
  EXPECT_NEAR(step.friction, -8.8, 1e-12);
}

TEST(Slider, BreaksLooseInsideTheStepAndFollowsTheClosedForm) {
  FrictionParameters box = foam_box();
  box.viscous = 0.0;
  const double rate = 100.0;  // N/s
  const double moving = 0.2 - box.limiting_force / rate;
  const double excess = box.limiting_force - box.coulomb_force;
  const double displacement =
      (0.5 * excess * moving * moving + rate * std::pow(moving, 3) / 6.0) / 3.0;
  for (const int steps : {1, 7, 200}) {
    SliderState state;
    double moving_time = 0.0;
    for (int i = 0; i < steps; ++i) {
      const double dt = 0.2 / steps;
      const SliderStep step = push(box, state, rate * i * dt, rate * (i + 1) * dt, dt);
      state = step.state;
      moving_time += step.moving_time;
    }
    EXPECT_NEAR(state.position, displacement, 1e-12) << steps;
    EXPECT_NEAR(moving_time, moving, 1e-12) << steps;
  }
}

TEST(Slider, StopsAsInTheClosedForm) {
  const FrictionParameters box = foam_box();
  const double v = 0.3;
  // M v' = -C - B v, from v to rest.
  const double ratio = box.viscous / box.coulomb_force;
  const double displacement = box.mass / box.viscous * (v - std::log1p(ratio * v) / ratio);
  const double time = box.mass / box.viscous * std::log1p(ratio * v);
  for (const double dt : {1.0, 0.01, 0.0007}) {
    SliderState state{0.0, v, FrictionPhase::sliding};
    double moving_time = 0.0;
    for (int i = 0; i * dt < 1.0; ++i) {
      const SliderStep step = push(box, state, 0.0, 0.0, dt);
      state = step.state;
      moving_time += step.moving_time;
    }
    EXPECT_NEAR(state.position, displacement, 1e-12) << dt;
    EXPECT_NEAR(moving_time, time, 1e-12) << dt;
    EXPECT_EQ(state.velocity, 0.0);
    EXPECT_EQ(state.phase, FrictionPhase::static_contact);
  }
}

TEST(Slider, WithoutViscousFrictionStopsAfterItsKineticEnergyOverTheForce) {
  FrictionParameters box = foam_box();
  box.viscous = 0.0;
  const SliderStep step = push(box, {0.0, -0.4, FrictionPhase::sliding}, 0.0, 0.0, 1.0);
  EXPECT_NEAR(step.state.position, -0.5 * 3.0 * 0.16 / 8.0, 1e-13);
  EXPECT_NEAR(step.dissipated, 0.5 * 3.0 * 0.16, 1e-13);
}

TEST(Slider, ReversesWithinAStepWhereTheLoadExceedsStaticFriction) {
  const SliderState forward{0.0, 0.1, FrictionPhase::sliding};
  const SliderState at_once = push(foam_box(), forward, -15.0, -15.0, 0.2).state;
  SliderState state = forward;
  for (int i = 0; i < 2000; ++i) state = push(foam_box(), state, -15.0, -15.0, 1e-4).state;
  EXPECT_LT(at_once.velocity, 0.0);
  EXPECT_NEAR(at_once.position, state.position, 1e-12);
  EXPECT_NEAR(at_once.velocity, state.velocity, 1e-12);
}

TEST(Slider, SticksAgainWhereTheLoadDoesNotExceedStaticFriction) {
  const SliderStep step = push(foam_box(), {0.0, 0.1, FrictionPhase::sliding}, -9.0, -9.0, 0.2);
  EXPECT_EQ(step.state.velocity, 0.0);
  EXPECT_EQ(step.state.phase, FrictionPhase::critical);
  EXPECT_EQ(step.friction, 9.0);
}

TEST(Slider, FindsAStopAndAReversalInOneStep) {
  // The load falls from 12 N to -30 N: the body stops, then slides backwards.
  SliderState state = push(foam_box(), {0.0, 0.01, FrictionPhase::sliding}, 12.0, -30.0, 0.1).state;
  SliderState fine{0.0, 0.01, FrictionPhase::sliding};
  for (int i = 0; i < 1000; ++i) {
    fine = push(foam_box(), fine, 12.0 - 0.042 * i, 12.0 - 0.042 * (i + 1), 1e-4).state;
  }
  EXPECT_NEAR(state.position, fine.position, 1e-10);
  EXPECT_NEAR(state.velocity, fine.velocity, 1e-9);
  EXPECT_LT(state.velocity, 0.0);
}

TEST(Slider, BreaksLooseAtOnceWhereItsLimitIsItsCoulombForce) {
  FrictionParameters box = foam_box();
  box.limiting_force = box.coulomb_force;
  EXPECT_GT(push(box, {}, 7.0, 9.0, 1e-3).state.velocity, 0.0);
  box.limiting_force = 2.0;  // invalid, below kinetic friction: the Coulomb force is the limit
  EXPECT_EQ(push(box, {}, 7.0, 7.9, 1e-3).state.velocity, 0.0);
}

/// A tool driven at 30 mm/s for 1.5 s, stopped, and retracted, behind a spring and a damper.
double pushed_by_a_tool(double dt) {
  SliderState state;
  const auto tool = [](double t) {
    return t < 1.5 ? 0.03 * t : std::max(0.045 - 0.05 * std::max(0.0, t - 2.0), 0.03);
  };
  const auto force = [&](double t, double position, double rate) {
    const double depth = tool(t) - position;
    return depth > 0.0 ? std::max(0.0, 4000.0 * depth + 20.0 * rate) : 0.0;
  };
  const int steps = static_cast<int>(std::lround(2.5 / dt));
  for (int i = 0; i < steps; ++i) {
    const double t = i * dt;
    const double rate = (tool(t + dt) - tool(t)) / dt - state.velocity;
    const double next = state.position + dt * state.velocity;
    state = push(foam_box(), state, force(t, state.position, rate), force(t + dt, next, rate), dt)
                .state;
  }
  return state.position;
}

TEST(Slider, PushedByASpringEndsAtTheSamePositionForHalfOneAndTwoMilliseconds) {
  const double reference = pushed_by_a_tool(1e-5);
  EXPECT_GT(reference, 0.04);
  for (const double dt : {0.0005, 0.001, 0.002}) {
    EXPECT_NEAR(pushed_by_a_tool(dt), reference, 1e-4) << dt;  // the required step-size tolerance
  }
}

TEST(Slider, IsPassive) {
  Random random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const FrictionParameters box{random.uniform(0.1, 10.0), random.uniform(0.0, 40.0), 1.0,
                                 random.uniform(0.0, 40.0), random.uniform(0.0, 50.0)};
    SliderState state{0.0, random.uniform(-1.0, 1.0), FrictionPhase::sliding};
    double force = random.uniform(-60.0, 60.0);
    for (int i = 0; i < 50; ++i) {
      const double next = random.uniform(-60.0, 60.0);
      const SliderStep step = push(box, state, force, next, random.uniform(0.0, 0.05));
      EXPECT_GE(step.dissipated, -1e-9) << trial;  // three-point quadrature of an exponential
      EXPECT_LE(step.friction * step.state.velocity, 0.0);
      state = step.state;
      force = next;
    }
  }
}

TEST(Slider, OfHalfStepsIsTheSameAsOfWholeOnes) {
  Random random(12);
  for (int trial = 0; trial < 300; ++trial) {
    FrictionParameters box = foam_box();
    box.viscous = trial % 3 == 0 ? 0.0 : random.uniform(0.0, 300.0);
    const SliderState start{0.0, random.uniform(-0.1, 0.1), FrictionPhase::sliding};
    const double a = random.uniform(-40.0, 40.0);
    const double b = random.uniform(-40.0, 40.0);
    const SliderState whole = push(box, start, a, b, 0.1).state;
    SliderState half = push(box, start, a, 0.5 * (a + b), 0.05).state;
    half = push(box, half, 0.5 * (a + b), b, 0.05).state;
    EXPECT_NEAR(half.position, whole.position, 1e-11) << trial;
    EXPECT_NEAR(half.velocity, whole.velocity, 1e-9) << trial;
  }
}

TEST(Slider, StaysAtRestForInvalidParametersOrLoad) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SliderState moving{1.0, 0.1, FrictionPhase::sliding};
  FrictionParameters negative = foam_box();
  negative.mass = -1.0;
  EXPECT_FALSE(is_physical(negative));
  for (const SliderStep& step :
       {push(negative, moving, 50.0, 50.0, 1e-3), push(foam_box(), moving, nan, 1.0, 1e-3),
        push(foam_box(), moving, 1.0, 1.0, nan)}) {
    EXPECT_EQ(step.state.position, 1.0);
    EXPECT_EQ(step.state.velocity, 0.0);
  }
}

TEST(Slider, OfZeroDurationDoesNotMove) {
  const SliderState moving{1.0, 0.1, FrictionPhase::sliding};
  const SliderState after = push(foam_box(), moving, 5.0, 5.0, 0.0).state;
  EXPECT_EQ(after.position, 1.0);
  EXPECT_EQ(after.velocity, 0.1);
}

}  // namespace
}  // namespace pcavr
