// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/sites/tool_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

struct Arm {
  double compliance = 2e-5;  ///< [m/N]
  double lag = 0.0;          ///< [s]
  double force = 20.0;       ///< [N] of its pushes
  double spike = 0.0;        ///< [N] of one sample in 300
};

/// Pushes along y of a second each, with the noise and the offsets of real sensors.
void push(const Arm& arm, int pushes, ToolResponse& found, double begin = 0.0) {
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
    found.add_setpoint(begin + t, setpoint);
    if (k % 2 != 0) continue;
    const Eigen::Vector3d tip = setpoint - arm.compliance * force - arm.lag * v + offset;
    const bool is_spike = arm.spike > 0.0 && k % 600 == 300;
    const Eigen::Vector3d spike(0.0, is_spike ? arm.spike : 0.0, 0.0);
    found.add_force(begin + t, force + spike + bias + noise(0.3));
    found.add_tip(begin + t, tip + noise(5e-5));
  }
}

TEST(ToolResponse, IsFoundFromAFewPushes) {
  ToolResponse found;
  push({}, 2, found);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(found.value()->compliance, 2e-5, 1e-6);
}

// The gap is that of a site that did not run for seconds.
TEST(ToolResponse, GoesOnAfterAGap) {
  ToolResponse found;
  push({}, 1, found);
  push({}, 2, found, 10.0);
  push({.compliance = 4e-5}, 12, found, 20.0);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(found.value()->compliance, 4e-5, 4e-6);
}

// A controller that is 50 ms late is no softer for it.
TEST(ToolResponse, IsNotTakenForALag) {
  ToolResponse found;
  push({.lag = 0.05}, 2, found);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(found.value()->compliance, 2e-5, 1e-6);
}

// A tip that something else moves; every message with such a response would be rejected.
TEST(ToolResponse, IsNotThatOfNoArm) {
  ToolResponse found;
  push({.compliance = 0.2}, 2, found);
  EXPECT_FALSE(found.value());
}

// Spikes of the sensor are forces without a shortfall.
TEST(ToolResponse, IsNotTakenForStifferByAForcesSpikes) {
  ToolResponse found;
  push({.force = 10.0, .spike = 35.0}, 4, found);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(found.value()->compliance, 2e-5, 6e-7);
}

/// A mass on a damped spring, under a force that rises slowly, falls fast, and rises again.
void push_sticking_object(double compliance, double mass, int pushes, ToolResponse& found) {
  constexpr double kStep = 0.001;        // [s]
  constexpr double kForce = 8.0;         // [N]
  constexpr double kSlip = 6.0;          // [N]
  constexpr double kPeriod = 0.08;       // [s]
  constexpr double kDampingRatio = 0.8;  // of a servo
  const double rate = 1.0 / std::sqrt(compliance * mass);
  Random random(5);
  Eigen::Vector3d shortfall = Eigen::Vector3d::Zero();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  const Eigen::Vector3d setpoint(0.5, 0.0, 0.1);
  for (int k = 0; k < 2000 * pushes; ++k) {
    const double t = kStep * k;
    const double phase = std::fmod(t, 2.0);
    const double share = std::clamp(std::min((phase - 0.8) / 0.2, (2.0 - phase) / 0.1), 0.0, 1.0);
    const double slip = kSlip * std::fmod(phase, kPeriod) / kPeriod;
    const Eigen::Vector3d force(0.0, share * (kForce + slip), 0.0);
    v += kStep * (force / mass - rate * rate * shortfall - 2.0 * kDampingRatio * rate * v);
    shortfall += kStep * v;
    found.add_setpoint(t, setpoint);
    if (k % 2 != 0) continue;
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    found.add_force(t, force + 0.2 * noise.reverse());
    found.add_tip(t, setpoint - shortfall + 5e-5 * noise);
  }
}

// The arm swings under it, and follows it less.
TEST(ToolResponse, IsNotTakenForStifferByAnObjectThatSticksAndSlips) {
  ToolResponse found;
  push_sticking_object(1.2e-5, 13.0, 10, found);
  ASSERT_TRUE(found.value());
  EXPECT_NEAR(found.value()->compliance, 1.2e-5, 3e-7);
}

// A damped spring between setpoint and tip, which is led to and fro and pressed in between, with a
// real sensor's noise.
TEST(ToolResponse, IsThatOfASpringBetweenSetpointAndTip) {
  for (const auto& [compliance, frequency, ratio] :
       {std::array{1.1e-5, 11.0, 0.8}, std::array{3e-5, 17.0, 0.8}, std::array{2e-5, 8.0, 1.1}}) {
    constexpr int kSubsteps = 10;
    constexpr double kStep = 0.001;  // [s]
    const double rate = 2.0 * std::numbers::pi * frequency;
    ToolResponse found;
    Random random(11);
    double shortfall = 0.0, v = 0.0, last = 0.0, last_speed = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      const double t = kStep * k;
      const double phase = std::fmod(t, 2.0);
      // 0.04 m/s to and fro with accelerations of up to 0.5 m/s^2; 10 N with the first half.
      const double setpoint = 0.0064 * (1.0 - std::cos(2.0 * std::numbers::pi * t));
      const double force = phase < 1.0 ? 5.0 * (1.0 - std::cos(2.0 * std::numbers::pi * t)) : 0.0;
      const double speed = k > 0 ? (setpoint - last) / kStep : 0.0;
      const double acceleration = k > 1 ? (speed - last_speed) / kStep : 0.0;
      last = setpoint;
      last_speed = speed;
      for (int i = 0; i < kSubsteps; ++i) {
        v += kStep / kSubsteps *
             (acceleration + rate * rate * (compliance * force - shortfall) -
              2.0 * ratio * rate * v);
        shortfall += kStep / kSubsteps * v;
      }
      found.add_setpoint(t, {0.5, setpoint, 0.1});
      if (k % 2 != 0) continue;
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      found.add_force(t, Eigen::Vector3d(0.0, force, 0.0) + 0.2 * noise.reverse());
      found.add_tip(t, Eigen::Vector3d(0.5, setpoint - shortfall, 0.1) + 5e-5 * noise);
    }
    ASSERT_TRUE(found.value());
    EXPECT_NEAR(found.value()->compliance, compliance, 0.02 * compliance) << frequency;
    EXPECT_NEAR(found.value()->lag, 0.0, 5e-4) << frequency;
    EXPECT_NEAR(found.value()->acceleration_lag, 1.0 / (rate * rate), 0.3 / (rate * rate))
        << frequency;
  }
}

/// An arm at rest that pushes an object which sticks and slips six times a second: the force rises,
/// and falls within 20 ms. A damped spring in substeps, with a real sensor's noise.
std::optional<TipResponse> response_to_slips(double compliance, double frequency, double ratio) {
  constexpr double kStep = 0.001;  // [s]
  constexpr int kSubsteps = 20;
  constexpr double kPeriod = 0.16, kFall = 0.02;  // [s]
  const double rate = 2.0 * std::numbers::pi * frequency;
  const auto force_at = [](double t) {
    const double phase = std::fmod(t, kPeriod);
    return 20.0 + 16.0 * std::min(phase / (kPeriod - kFall), (kPeriod - phase) / kFall);
  };
  ToolResponse found;
  Random random(7);
  double shortfall = 0.0, v = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const double t = kStep * k;
    found.add_setpoint(t, {0.5, 0.0, 0.1});
    if (k % 2 == 0) {
      const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
      found.add_force(t, Eigen::Vector3d(0.0, force_at(t), 0.0) + 0.2 * noise.reverse());
      found.add_tip(t, Eigen::Vector3d(0.5, -shortfall, 0.1) + 5e-5 * noise);
    }
    for (int i = 0; i < kSubsteps; ++i) {
      const double dt = kStep / kSubsteps;
      const double force = force_at(t + (i + 0.5) * dt);
      v += dt * (rate * rate * (compliance * force - shortfall) - 2.0 * ratio * rate * v);
      shortfall += dt * v;
    }
  }
  return found.value();
}

// The grid's neighbours are 12 % and 20 % apart.
TEST(ToolResponse, HasRateAndDampingBetweenThoseOfItsGrid) {
  for (const double frequency : {9.3, 10.9, 11.4, 13.6, 16.3}) {
    const std::optional<TipResponse> found = response_to_slips(3e-5, frequency, 0.8);
    ASSERT_TRUE(found);
    const double rate = 2.0 * std::numbers::pi * frequency;
    EXPECT_NEAR(found->rate, rate, 0.05 * rate) << frequency;
    EXPECT_NEAR(found->damping_ratio, 0.8, 0.05) << frequency;
    EXPECT_NEAR(found->compliance, 3e-5, 6e-7) << frequency;
  }
}

TEST(ToolResponse, IsUnknownWithoutAContactAndOfAStiffArm) {
  ToolResponse untouched;
  push({.force = 0.0}, 3, untouched);
  EXPECT_FALSE(untouched.value());
  ToolResponse stiff;
  push({.compliance = 0.0}, 3, stiff);
  EXPECT_FALSE(stiff.value());
}

}  // namespace
}  // namespace pcavr
