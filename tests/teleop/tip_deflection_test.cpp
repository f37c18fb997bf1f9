// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/tip_deflection.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kTipStep = 0.001;  // [s]

// The tip is drawn back from a pushed object: the force ends and the command accelerates to 0.1 m/s
// within 50 ms, which a spring of 15 Hz follows 0.1 mm late.
TEST(TipDeflection, IsThatOfADampedSpringBetweenCommandAndTip) {
  constexpr double kRate = 94.0;  // [rad/s]
  constexpr double kDampingRatio = 0.8;
  constexpr double kCompliance = 1e-5;   // [m/N]
  constexpr double kAcceleration = 2.0;  // [m/s^2]
  constexpr int kSubsteps = 20;
  TipDeflection deflection;
  deflection.set_response({kCompliance, kRate, kDampingRatio, 0.0, 1.0 / (kRate * kRate)});
  double expected = 0.0, v = 0.0, command = 0.0, speed = 0.0, max_lag = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const bool is_pressed = k < 500;
    const bool is_accelerated = !is_pressed && k < 550;
    const double force = is_pressed ? 40.0 : std::max(0.0, 40.0 - 0.8 * (k - 500));
    if (is_accelerated) speed += kAcceleration * kTipStep;
    command += speed * kTipStep;
    for (int i = 0; i < kSubsteps; ++i) {
      v += kTipStep / kSubsteps *
           ((is_accelerated ? kAcceleration : 0.0) +
            kRate * kRate * (kCompliance * force - expected) - 2.0 * kDampingRatio * kRate * v);
      expected += kTipStep / kSubsteps * v;
    }
    deflection.step({command, 0.0, 0.0}, {force, 0.0, 0.0}, kTipStep);
    EXPECT_NEAR(deflection.p_base().x(), expected, 2e-5) << k;
    if (!is_pressed) max_lag = std::max(max_lag, expected - kCompliance * force);
  }
  EXPECT_GT(max_lag, 1e-4);
}

// An arm with a computed torque, behind a delay.
TEST(TipDeflection, IsItsLagAtASteadySpeed) {
  TipDeflection deflection;
  deflection.set_response({1e-5, 60.0, 1.0, 0.01, 0.0});
  for (int k = 0; k < 1000; ++k) {
    deflection.step({0.05 * kTipStep * k, 0.0, 0.0}, Eigen::Vector3d::Zero(), kTipStep);
  }
  EXPECT_NEAR(deflection.p_base().x(), 5e-4, 1e-6);
}

TEST(TipDeflection, IsNoneOfAnArmThatIsNotKnown) {
  TipDeflection deflection;
  for (int k = 0; k < 10; ++k) {
    deflection.step({0.01 * k * k, 0.0, 0.0}, {20.0, 0.0, 0.0}, kTipStep);
    EXPECT_TRUE(deflection.p_base().isZero());
  }
}

}  // namespace
}  // namespace pcavr
