// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"

#include "haptics/scanned_bumps.hpp"

namespace pcavr {
namespace {

TriangleMesh flat_square() {
  TriangleMesh mesh;
  mesh.vertices = {
      {-1.0F, -1.0F, 0.0F}, {1.0F, -1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}, {-1.0F, 1.0F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Presses from 0.1 m above to `depth` [m] below at one place, a millimetre a step.
ProxyState press(SurfaceProxy& proxy, double depth) {
  EXPECT_TRUE(proxy.reset({0.1, 0.2, 0.1}));
  ProxyState state;
  for (double z = 0.1; z > -depth; z -= 0.001) state = proxy.step({0.1, 0.2, z});
  return state;
}

TEST(SurfaceProxy, IsTheTipInFreeSpace) {
  SurfaceProxy proxy(flat_square(), {});
  ASSERT_TRUE(proxy.reset({0.0, 0.0, 0.5}));
  const ProxyState state = proxy.step({0.3, -0.2, 0.4});
  EXPECT_EQ(state.centre, Eigen::Vector3d(0.3, -0.2, 0.4));
  EXPECT_FALSE(state.is_inside);
}

TEST(SurfaceProxy, RestsARadiusAboveAPlaneAndSlidesWithTheTip) {
  SurfaceProxy proxy(flat_square(), {});
  ProxyState state = press(proxy, 0.005);
  EXPECT_TRUE(state.is_inside);
  for (int i = 1; i <= 100; ++i) state = proxy.step({0.1 - i * 0.002, 0.2, -0.005});
  EXPECT_NEAR((state.centre - Eigen::Vector3d(-0.1, 0.2, 0.001)).norm(), 0.0, 1e-9);
}

TEST(SurfaceProxy, IsFreeAgainOnTheSideItCameFrom) {
  SurfaceProxy proxy(flat_square(), {});
  (void)press(proxy, 0.02);
  ProxyState state = proxy.step({0.1, 0.2, 0.0009});
  EXPECT_TRUE(state.is_inside);
  state = proxy.step({0.1, 0.2, 0.0011});
  EXPECT_FALSE(state.is_inside);
  EXPECT_EQ(state.centre, Eigen::Vector3d(0.1, 0.2, 0.0011));
}

TEST(SurfaceProxy, HasNoPopThroughAtAnySpeed) {
  SurfaceProxy proxy(flat_square(), test::proxy_options(0.0001, 0.0));
  ASSERT_TRUE(proxy.reset({0.1, 0.2, 0.5}));
  const ProxyState state = proxy.step({0.1, 0.2, -0.5});
  EXPECT_TRUE(state.is_inside);
  EXPECT_NEAR(state.centre.z(), 0.0001, 1e-9);
}

TEST(SurfaceProxy, LagsByTheFrictionCone) {
  constexpr double kFriction = 0.5;
  SurfaceProxy proxy(flat_square(), test::proxy_options(0.001, kFriction));
  const double z = press(proxy, 0.004).centre.z();
  // Inside the cone it sticks; outside it slides at the cone's edge.
  double x = 0.1;
  ProxyState state;
  for (int i = 0; i < 20; ++i) state = proxy.step({x += 0.0001, 0.2, -0.004});
  EXPECT_NEAR(state.centre.x(), 0.1, 1e-12);
  for (int i = 0; i < 500; ++i) state = proxy.step({x += 0.0001, 0.2, -0.004});
  EXPECT_NEAR(x - state.centre.x(), kFriction * (z + 0.004), 1e-9);
}

TEST(SurfaceProxy, WaitsForAFreeTipBeforeItsFirstContact) {
  SurfaceProxy proxy(flat_square(), {});
  EXPECT_FALSE(proxy.reset({0.0, 0.0, 0.0005}));
  EXPECT_FALSE(proxy.step({0.0, 0.0, 0.0}).is_inside);
  EXPECT_FALSE(proxy.step({0.0, 0.0, 0.01}).is_inside);
  EXPECT_TRUE(proxy.step({0.0, 0.0, 0.0}).is_inside);
}

TEST(SurfaceProxy, StaysWhereItIsWhenTheTipIsNotFinite) {
  SurfaceProxy proxy(flat_square(), {});
  const Eigen::Vector3d before = press(proxy, 0.005).centre;
  const ProxyState state =
      proxy.step(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(state.centre, before);
  EXPECT_FALSE(state.is_inside);
  EXPECT_TRUE(proxy.step({0.1, 0.2, -0.005}).is_inside);
}

TEST(SurfaceProxy, IsFreeWithoutTriangles) {
  SurfaceProxy proxy(TriangleMesh{}, {});
  ASSERT_TRUE(proxy.reset({0.0, 0.0, 0.0}));
  EXPECT_EQ(proxy.step({0.0, 0.0, -1.0}).centre, Eigen::Vector3d(0.0, 0.0, -1.0));
}

TEST(SurfaceProxy, RejectsInvalidInput) {
  EXPECT_THROW(SurfaceProxy(flat_square(), test::proxy_options(0.0, 0.0)), ContractError);
  EXPECT_THROW(SurfaceProxy(flat_square(), test::proxy_options(0.001, -0.1)), ContractError);
  TriangleMesh invalid = flat_square();
  invalid.triangles.push_back({0, 1, 4});
  EXPECT_THROW(SurfaceProxy(invalid, {}), ContractError);
}

// The smooth bumps' slope is at most 1/2: a tip 5 mm deep has its nearest surface within 5 mm.
TEST(SurfaceProxy, LagsLittleOnSmoothBumps) {
  const test::ScannedBumps bumps(150, 0.0, 1);
  SurfaceProxy proxy(bumps.mesh(), test::proxy_options(0.001, 0.0));
  const test::PressAndSlide hand(3);
  ASSERT_TRUE(proxy.reset(hand(0.0) + Eigen::Vector3d(0.0, 0.0, 0.02)));
  for (int i = 0; i < 10'000; ++i) {
    const double t = i * 0.001;
    const Eigen::Vector3d tip = hand(t) + Eigen::Vector3d(0.0, 0.0, std::max(0.0, 0.02 - 0.1 * t));
    const Eigen::Vector3d centre = proxy.step(tip).centre;
    ASSERT_GE(bumps.distance(centre, 0.001), 0.001 - 1e-9) << i;
    ASSERT_LT((centre - tip).head<2>().norm(), 0.008) << i;
  }
}

// Twice the tip's motion is enough to reach the point nearest to the tip; no more is used.
TEST(SurfaceProxy, LagsLessWhereItMayMoveFartherThanTheTip) {
  const test::ScannedBumps bumps(150, 0.0, 1);
  const test::PressAndSlide hand(3);
  double lag[2] = {};
  for (const int motion : {1, 2}) {
    SurfaceProxy proxy(bumps.mesh(), test::proxy_options(0.001, 0.0, static_cast<double>(motion)));
    Eigen::Vector3d tip = hand(0.0) + Eigen::Vector3d(0.0, 0.0, 0.02);
    ASSERT_TRUE(proxy.reset(tip));
    Eigen::Vector3d centre = tip;
    for (int i = 0; i < 10'000; ++i) {
      const double t = i * 0.001;
      const Eigen::Vector3d next =
          hand(t) + Eigen::Vector3d(0.0, 0.0, std::max(0.0, 0.02 - 0.1 * t));
      const Eigen::Vector3d next_centre = proxy.step(next).centre;
      ASSERT_LE((next_centre - centre).norm(), motion * (next - tip).norm() + 1e-12) << i;
      tip = next;
      centre = next_centre;
      lag[motion - 1] += (centre - tip).head<2>().norm();
    }
  }
  EXPECT_LT(lag[1], lag[0]);
}

}  // namespace
}  // namespace pcavr
