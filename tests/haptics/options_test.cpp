// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/teleoperation/haptics/haptic_world.hpp"
#include "pcavr/teleoperation/haptics/rendered_force.hpp"
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

#include "haptics/scanned_bumps.hpp"
#include "haptics/tabletop.hpp"
#include "support/option_defaults.hpp"

namespace pcavr {
namespace {

using test::kCycle;

TEST(HapticOptions, HaveTheirDocumentedDefaults) {
  test::expect_documented_defaults<ForceOptions>();
  test::expect_documented_defaults<ProxyOptions>();
  test::expect_documented_defaults<HapticWorldOptions>();
  EXPECT_EQ(ForceOptions().max_rate(), 2000.0);
}

TEST(HapticOptions, SectionRejectsAMinimumForceAboveTheMaximum) {
  ForceOptions options;
  const OptionSection section = section_of(options);
  EXPECT_FALSE(section.check());
  options.max_force = 0.1;
  options.min_force = 0.2;
  EXPECT_TRUE(section.check());
}

/// The force at rest 3 mm inside of a floor, after a slow press.
double force_at_rest(const ForceOptions& options) {
  RenderedForce rendered(options);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (int i = 0; i < 400; ++i) {
    const double depth = std::min(1e-5 * i, 0.003);
    force = rendered.step({0.0, 0.0, -depth}, {0.0, 0.0, 0.0}, true, kCycle);
  }
  return force.z();
}

TEST(HapticOptions, StiffnessAndLimitDetermineTheForce) {
  ForceOptions options;
  EXPECT_NEAR(force_at_rest(options), 3.0, 1e-9);
  options.stiffness = 500.0;
  EXPECT_NEAR(force_at_rest(options), 1.5, 1e-9);
  options.max_force = 1.0;
  EXPECT_NEAR(force_at_rest(options), 1.0, 1e-9);
}

TEST(HapticOptions, ForceRisesWithinItsRiseTime) {
  ForceOptions options;
  options.rise_time = 0.05;
  RenderedForce rendered(options);
  (void)rendered.step({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, false, kCycle);
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int i = 1; i <= 20; ++i) {  // 0.5 m/s: the law's force would rise by 0.5 N in each cycle
    const Eigen::Vector3d force =
        rendered.step({0.0, 0.0, -5e-4 * i}, {0.0, 0.0, 0.0}, true, kCycle);
    EXPECT_LE((force - before).norm(), 5.0 * kCycle / 0.05 + 2.0 * options.min_force) << i;
    before = force;
  }
}

TEST(HapticOptions, ALargerRadiusKeepsTheProxyFartherFromTheSurface) {
  for (const double radius : {0.001, 0.01}) {
    const test::ScannedBumps floor(50, 0.0, 1);
    SurfaceProxy proxy(floor.mesh(), test::proxy_options(radius, 0.0));
    ASSERT_TRUE(proxy.reset({0.15, 0.15, 0.1}));
    const Eigen::Vector3d tip(0.15, 0.15, -0.1);
    for (int i = 1; i <= 200; ++i) {
      const double share = i / 200.0;
      (void)proxy.step(Eigen::Vector3d(0.15, 0.15, 0.1 - 0.2 * share));
    }
    const ProxyState state = proxy.step(tip);
    EXPECT_TRUE(state.is_inside);
    EXPECT_GE(floor.distance(state.centre, 1.0), radius - 1e-6) << radius;
  }
}

/// Displacement along x of the proxy that the hand drags over the table, 5 mm below its surface.
double dragged(double friction) {
  HapticWorldModel model = test::one_box_on_a_table();
  model.world.bodies.clear();
  model.options.scan_friction = friction;
  HapticWorld world = HapticWorld::create(model).value();
  world.reset({0.0, 0.2, 0.02});
  Eigen::Vector3d hand(0.0, 0.2, 0.02);
  for (int i = 0; i < 50; ++i) {
    hand.z() -= 3e-4;
    world.step({hand, true}, kCycle);
  }
  const double start = world.state().p_base_proxy.x();
  for (int i = 0; i < 50; ++i) {
    hand.x() += 1e-4;
    world.step({hand, true}, kCycle);
  }
  return world.state().p_base_proxy.x() - start;
}

TEST(HapticOptions, FrictionOfTheScanHoldsTheProxyBack) {
  EXPECT_NEAR(dragged(0.0), 0.005, 5e-4);
  EXPECT_LT(dragged(2.0), 0.001);
}

/// Height of the box, pushed over the table's edge and 3 s later.
double fallen_height(const HapticWorldOptions& options) {
  HapticWorldModel model = test::one_box_on_a_table();
  model.options = options;
  HapticWorld world = HapticWorld::create(model).value();
  const Eigen::Vector3d start = test::touching_tip() - Eigen::Vector3d(0.002, 0.0, 0.0);
  world.reset(start);
  for (double x = 0.0; x < 0.54; x += 0.2 * kCycle) {
    world.step({start + Eigen::Vector3d(x, 0.0, 0.0), true}, kCycle);
  }
  for (int i = 0; i < 3000; ++i) world.step({{0.0, 0.0, 0.3}, false}, kCycle);
  return world.state().bodies[0].T_base_object.translation().z();
}

TEST(HapticOptions, BodiesFallToTheMaximumHeight) {
  HapticWorldOptions options;
  EXPECT_LT(fallen_height(options), -4.0);
  options.max_fall_height = 1.0;
  EXPECT_NEAR(fallen_height(options), -1.0, 0.1);
}

TEST(HapticOptions, BodiesFarAboveTheirSupportNeverFall) {
  HapticWorldModel model = test::one_box_on_a_table();
  for (Eigen::Vector3d& corner : model.supports_base[0]) corner.z() = -0.01;  // an error of 10 mm
  const auto falls = [&](double tolerance) {
    model.options.support_height_tolerance = tolerance;
    HapticWorld world = HapticWorld::create(model).value();
    const Eigen::Vector3d start = test::touching_tip() - Eigen::Vector3d(0.002, 0.0, 0.0);
    world.reset(start);
    for (double x = 0.0; x < 0.54; x += 0.2 * kCycle) {
      world.step({start + Eigen::Vector3d(x, 0.0, 0.0), true}, kCycle);
    }
    return world.state().bodies[0].is_outside_model;
  };
  EXPECT_TRUE(falls(0.02));
  EXPECT_FALSE(falls(0.005));
}

/// [N] of the tool on a box that cannot be moved, the hand 60 mm inside of it.
double force_on_a_fixed_box(double max_push_force) {
  HapticWorldModel model = test::one_box_on_a_table();
  model.world.bodies[0].physics.friction.limiting_force = 1000.0;
  model.options.max_push_force = max_push_force;
  model.force.max_force = 500.0;
  HapticWorld world = HapticWorld::create(model).value();
  const Eigen::Vector3d start = test::touching_tip() - Eigen::Vector3d(0.002, 0.0, 0.0);
  world.reset(start);
  for (int i = 0; i < 1000; ++i) {
    world.step({start + Eigen::Vector3d(std::min(1e-4 * i, 0.06), 0.0, 0.0), true}, kCycle);
  }
  return world.state().bodies[0].tool_force_base.norm();
}

TEST(HapticOptions, TheHandPushesWithItsMaximumForce) {
  EXPECT_NEAR(force_on_a_fixed_box(200.0), 200.0, 10.0);
  EXPECT_NEAR(force_on_a_fixed_box(50.0), 50.0, 3.0);
}

}  // namespace
}  // namespace pcavr
