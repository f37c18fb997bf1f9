// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "prediction/scan_clutter.hpp"

namespace pcavr {
namespace {

constexpr double kMaxDepth = 0.002;  // [m] without noise
constexpr double kFootNoise = 0.005;

struct Outcome {
  double depth = 0.0;  ///< [m] of the deepest scan point, at any time
  BodyState last;
};

Outcome push_into_clutter(const test::ScanPush& push, double dt = 0.001) {
  const WorldModel model = test::world_of(push);
  const test::ScanDepth depth(model.bodies[0], model.static_mesh_base, kFootNoise);
  PredictedWorld world = PredictedWorld::create(model).value();
  Outcome outcome;
  const auto path = [&](double t) { return test::tip_at(push, t); };
  int step = 0;
  test::run(world, path, 0.2 / push.speed + 0.2, dt, [&](double) {
    if (++step % 5 == 0) {
      outcome.depth = std::max(outcome.depth, depth.deepest(world.T_base_object(0)));
    }
  });
  outcome.last = world.state()[0];
  return outcome;
}

class ScanContact : public testing::TestWithParam<std::string_view> {};

TEST_P(ScanContact, NoScanPointGetsDeepIntoAPushedBody) {
  const bool is_full = std::getenv("PCAVR_FULL_GRID") != nullptr;
  const std::vector<double> speeds =
      is_full ? std::vector{0.05, 0.1, 0.15, 0.3, 0.5} : std::vector{0.15};
  const std::vector<double> noises = is_full ? std::vector{0.0, 0.001, 0.002} : std::vector{0.002};
  double worst = 0.0;
  for (const double speed : speeds) {
    for (const double noise : noises) {
      for (const double offset : {-0.045, -0.02, 0.0, 0.02, 0.045}) {
        const Outcome outcome = push_into_clutter(
            {.shape = GetParam(), .speed = speed, .offset = offset, .noise = noise});
        EXPECT_LE(outcome.depth, kMaxDepth + noise)
            << GetParam() << ", " << speed << " m/s, offset " << offset << " m, noise " << noise;
        worst = std::max(worst, outcome.depth - noise);
      }
    }
  }
  std::printf("%s: deepest scan point less noise: %.2f mm\n", GetParam().data(), 1e3 * worst);
}

// 23 mm of the tip's travel after the box has reached the cup: 460 N.
TEST(ScanContact, ABodyThatTheScanHoldsIsBlockedAndALimitedForceIsSaturated) {
  for (const double max_force : {2000.0, 100.0}) {
    const test::ScanPush push{.clutter_y = 0.0};
    WorldModel model = test::world_of(push);
    model.options.max_contact_force = max_force;
    PredictedWorld world = PredictedWorld::create(model).value();
    const auto path = [&](double t) { return test::tip_at(push, std::min(t, 0.5)); };
    test::run(world, path, 0.3, 0.001);
    EXPECT_FALSE(world.state()[0].is_blocked) << "on its way";
    test::run(
        world, [&](double t) { return path(t + 0.3); }, 0.5, 0.001);
    const BodyState& state = world.state()[0];
    EXPECT_TRUE(state.is_blocked) << max_force;
    EXPECT_EQ(state.is_saturated, max_force < 460.0);
    EXPECT_NE(state.phase, MotionPhase::free);
    EXPECT_NEAR(state.planar.position.x(), 0.05, 0.002);
  }
}

INSTANTIATE_TEST_SUITE_P(Clutter, ScanContact, testing::ValuesIn(test::kClutter));

}  // namespace
}  // namespace pcavr
