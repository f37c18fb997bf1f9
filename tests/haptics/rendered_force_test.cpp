// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/rendered_force.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]

/// The force after each cycle of a press down to -`depth` [m] of a floor at 0 at `speed` [m/s].
std::vector<Eigen::Vector3d> press(RenderedForce& rendered, double depth, double speed) {
  std::vector<Eigen::Vector3d> forces;
  for (double z = 0.01; z > -depth; z -= speed * kCycle) {
    forces.push_back(
        rendered.step({0.0, 0.0, z}, Eigen::Vector3d(0.0, 0.0, std::max(z, 0.0)), z < 0.0, kCycle));
  }
  return forces;
}

TEST(RenderedForce, IsTheLawsForceForATipAtRest) {
  ForceOptions options;
  options.stiffness = 800.0;
  options.damping = 1.0;
  RenderedForce rendered(options);
  (void)press(rendered, 0.003, 0.05);
  Eigen::Vector3d force;
  for (int i = 0; i < 5; ++i)
    force = rendered.step({0.0, 0.0, -0.003}, {0.0, 0.0, 0.0}, true, kCycle);
  EXPECT_NEAR((force - Eigen::Vector3d(0.0, 0.0, 2.4)).norm(), 0.0, 1e-12);
}

TEST(RenderedForce, FollowsTheExponent) {
  ForceOptions options;
  options.stiffness = 20'000.0;
  options.exponent = 1.5;
  RenderedForce rendered(options);
  (void)press(rendered, 0.003, 0.05);
  Eigen::Vector3d force;
  for (int i = 0; i < 5; ++i)
    force = rendered.step({0.0, 0.0, -0.003}, {0.0, 0.0, 0.0}, true, kCycle);
  EXPECT_NEAR(force.z(), 20'000.0 * std::pow(0.003, 1.5), 1e-12);
}

TEST(RenderedForce, IsLimitedInMagnitudeAndRate) {
  ForceOptions options;
  options.stiffness = 1e5;
  RenderedForce rendered(options);
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double max_force = 0.0;
  for (const Eigen::Vector3d& force : press(rendered, 0.01, 0.2)) {
    EXPECT_LE((force - before).norm(), options.max_rate() * kCycle + options.min_force);
    max_force = std::max(max_force, force.norm());
    before = force;
  }
  EXPECT_NEAR(max_force, options.max_force, 1e-12);
}

TEST(RenderedForce, IsNeverZeroInsideHoweverSlowTheContact) {
  RenderedForce rendered{ForceOptions{}};
  for (int i = 1; i <= 1000; ++i) {
    const Eigen::Vector3d force =
        rendered.step({0.0, 0.0, -1e-7 * i}, {0.0, 0.0, 0.0}, true, kCycle);
    ASSERT_GT(force.z(), 0.0) << i;
  }
}

TEST(RenderedForce, DiscardsTheTipWhenANumberIsNotFinite) {
  RenderedForce rendered{ForceOptions{}};
  (void)press(rendered, 0.003, 0.05);
  const double energy = rendered.available_energy();
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(rendered.step({none, 0.0, 0.0}, {0.0, 0.0, 0.0}, true, kCycle),
            Eigen::Vector3d::Zero());
  EXPECT_EQ(rendered.step({0.0, 0.0, -0.003}, {0.0, 0.0, 0.0}, true, 0.0), Eigen::Vector3d::Zero());
  EXPECT_EQ(rendered.available_energy(), energy);
}

TEST(RenderedForce, RejectsInvalidOptions) {
  ForceOptions options;
  options.stiffness = 0.0;
  EXPECT_THROW(RenderedForce{options}, ContractError);
  options = {};
  options.min_force = 2.0 * options.max_force;
  EXPECT_THROW(RenderedForce{options}, ContractError);
}

}  // namespace
}  // namespace pcavr
