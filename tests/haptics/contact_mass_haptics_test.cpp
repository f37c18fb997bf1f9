// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/contact/contact_law.hpp"

#include "haptics/tabletop.hpp"
#include "teleoperation/haptics/tip_acceleration.hpp"

namespace pcavr {
namespace {

using test::kCycle;
using test::touching_tip;

constexpr double kOmega = 2.0 * std::numbers::pi * 10.0;  // [rad/s] of the modulation
constexpr KelvinVoigt kLaw{8000.0, 20.0};
constexpr double kContactMass = 0.5;  // [kg]

HapticWorld pressed_world(double mass) {
  HapticWorldModel model = test::one_box_on_a_table();
  model.force.max_force = 200.0;
  model.world.bodies[0].is_movable = false;
  model.world.bodies[0].physics.contact = {kLaw.stiffness, kLaw.damping, 1.0};
  model.world.bodies[0].physics.contact_mass = mass;
  HapticWorld world = HapticWorld::create(model).value();
  world.reset(touching_tip());
  return world;
}

/// The depth grows to 3 mm within 0.3 s, then varies by +- 1 mm at 10 Hz.
double depth_at(double t) {
  const double in = 0.003 * std::clamp(t / 0.3, 0.0, 1.0);
  return in + (t < 0.5 ? 0.0 : 0.001 * std::sin(kOmega * (t - 0.5)));
}

/// Complex amplitude of the rendered force over that of the law with the mass, less 1.
double amplitude_error(double mass) {
  HapticWorld world = pressed_world(mass);
  std::complex<double> rendered = 0.0;
  int count = 0;
  for (int i = 0; i < 2500; ++i) {
    const double t = kCycle * i;
    world.step({touching_tip() + Eigen::Vector3d(depth_at(t), 0.0, 0.0), true}, kCycle);
    if (t < 1.5) continue;
    rendered -= world.state().force_base.x() * std::polar(1.0, -kOmega * (t - 0.5));
    ++count;
  }
  const std::complex<double> law(kLaw.stiffness - kContactMass * kOmega * kOmega,
                                 kLaw.damping * kOmega);
  const std::complex<double> expected = 0.001 * law / std::complex<double>(0.0, 1.0);
  return std::abs(2.0 / count * rendered - expected) / std::abs(expected);
}

TEST(HapticWorld, RendersTheMassOfAContactWithin2PercentAt10Hertz) {
  EXPECT_LT(amplitude_error(kContactMass), 0.02);
  EXPECT_GT(amplitude_error(0.0), 0.25);
}

TEST(HapticWorld, ReturnsNoEnergyThroughTheMassOfAContact) {
  HapticWorld world = pressed_world(2.0);
  Random random(7);
  double taken = 0.0, lowest = 0.0;
  Eigen::Vector3d before = touching_tip();
  for (int i = 0; i < 20'000; ++i) {
    // A hand that shakes at 3 and 13 Hz, in and out of the contact, and a device's noise.
    const double t = kCycle * i;
    const double depth = 0.002 * std::sin(19.0 * t) + 0.0015 * std::sin(82.0 * t);
    const Eigen::Vector3d tip =
        touching_tip() + Eigen::Vector3d(depth + 2e-6 * random.normal(), 0.0, 0.0);
    taken -= world.state().force_base.dot(tip - before);
    lowest = std::min(lowest, taken);
    before = tip;
    world.step({tip, true}, kCycle);
  }
  EXPECT_GT(lowest, -1e-6);  // [J]
}

TEST(TipAcceleration, IsExactForACubicAndLimited) {
  detail::TipAcceleration acceleration(0.01, 20.0);
  const auto at = [](double t) { return Eigen::Vector3d(t * t * t, 3.0 * t * t, 0.2 - t); };
  for (int i = 0; i < 100; ++i) {
    acceleration.add(at(kCycle * i), kCycle);
    const Eigen::Vector3d expected =
        i < 9 ? Eigen::Vector3d(0.0, 0.0, 0.0) : Eigen::Vector3d(6.0 * kCycle * i, 6.0, 0.0);
    EXPECT_LT((acceleration.value() - expected).norm(), 1e-6) << i;
  }
  acceleration.add({10.0, 0.0, 0.0}, kCycle);
  EXPECT_NEAR(acceleration.value().norm(), 20.0, 1e-9);
  acceleration.reset();
  EXPECT_TRUE(acceleration.value().isZero(0.0));
}

}  // namespace
}  // namespace pcavr
