// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "sites/tool_compliance.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/core/random.hpp"

namespace pcavr {
namespace {

struct Arm {
  double compliance = 2e-5;  ///< [m/N]
  double lag = 0.0;          ///< [s]
  double force = 20.0;       ///< [N] of its pushes
};

/// Pushes along y of a second each, with the noise and the offsets of real sensors.
void push(const Arm& arm, int pushes, ToolCompliance& found) {
  constexpr double kStep = 0.001;   // [s]
  constexpr double kSpeed = 0.004;  // [m/s]
  const Eigen::Vector3d offset(3e-4, -2e-4, 5e-4);
  const Eigen::Vector3d bias(1.0, -4.0, 2.0);
  Random random(3);
  const auto noise = [&](double std) {
    return Eigen::Vector3d(std * random.normal(), std * random.normal(), std * random.normal());
  };
  for (int k = 0; k < 2000 * pushes; ++k) {
    const double t = kStep * k;
    const double phase = std::fmod(t, 2.0);
    const Eigen::Vector3d setpoint(0.5, kSpeed * std::min(phase, 2.0 - phase), 0.1);
    const Eigen::Vector3d v(0.0, phase < 1.0 ? kSpeed : -kSpeed, 0.0);
    const Eigen::Vector3d force(0.0, arm.force * std::min(phase, 2.0 - phase), 0.0);
    found.add_setpoint(t, setpoint);
    if (k % 2 != 0) continue;
    const Eigen::Vector3d tip = setpoint - arm.compliance * force - arm.lag * v + offset;
    found.add_sample(t, tip + noise(5e-5), force + bias + noise(0.3));
  }
}

TEST(ToolCompliance, IsFoundFromAFewPushes) {
  ToolCompliance found;
  push({}, 2, found);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(*found.value(), 2e-5, 1e-6);
}

// A controller that is 50 ms late is no softer for it.
TEST(ToolCompliance, IsNotTakenForALag) {
  ToolCompliance found;
  push({.lag = 0.05}, 2, found);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(*found.value(), 2e-5, 1e-6);
}

TEST(ToolCompliance, IsUnknownWithoutAContactAndOfAStiffArm) {
  ToolCompliance untouched;
  push({.force = 0.0}, 3, untouched);
  EXPECT_FALSE(untouched.value());
  ToolCompliance stiff;
  push({.compliance = 0.0}, 3, stiff);
  EXPECT_FALSE(stiff.value());
}

}  // namespace
}  // namespace pcavr
