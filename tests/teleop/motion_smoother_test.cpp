// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/motion_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kTipInterval = 0.002;  // [s]
constexpr double kTipNoise = 5e-5;      // [m]

struct Motion {
  std::vector<double> t, exact, measured;
};

template <class Path>
Motion measure(const Path& path, double duration, std::uint64_t seed) {
  Motion motion;
  Random random(seed);
  for (double t = 0.0; t < duration; t += kTipInterval) {
    motion.t.push_back(t);
    motion.exact.push_back(path(t));
    motion.measured.push_back(motion.exact.back() + kTipNoise * random.normal());
  }
  return motion;
}

/// Root mean square of the smoothed motion's error from `begin` to `end` [s], over ten seeds [m].
template <class Path>
double error_of(const Path& path, double begin, double end) {
  double squares = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Motion motion = measure(path, 3.0, seed);
    const std::vector<MotionSample> found = smooth_motion(motion.t, motion.measured, kTipNoise);
    for (std::size_t k = 0; k < motion.t.size(); ++k) {
      if (motion.t[k] < begin || motion.t[k] > end) continue;
      squares += std::pow(found[k].position - motion.exact[k], 2);
      count += 1.0;
    }
  }
  return std::sqrt(squares / count);
}

/// A press down at 10 mm/s, held for 0.3 s from 1.5 s on, and away at 50 mm/s.
double held_press(double t) {
  const double down = -0.01 * std::min(t, 1.5);
  return down + 0.05 * std::max(0.0, t - 1.8);
}

TEST(SmoothMotion, AveragesTheNoiseOfAHeldTipUpToItsEnds) {
  // A window of +-20 ms leaves 18 um. One of +-80 ms leaves 9 um, but errs by 60 um where the tip
  // leaves.
  EXPECT_LT(error_of(held_press, 1.55, 1.75), 1.3e-5);
  EXPECT_LT(error_of(held_press, 1.48, 1.82), 1.6e-5);
}

TEST(SmoothMotion, FollowsAHandOf10Hertz) {
  const auto hand = [](double t) { return 0.001 * std::sin(20.0 * std::numbers::pi * t); };
  EXPECT_LT(error_of(hand, 0.5, 2.5), 3e-5);
}

TEST(SmoothMotion, IsExactWithoutNoise) {
  const Motion motion = measure(held_press, 3.0, 1);
  const std::vector<MotionSample> found = smooth_motion(motion.t, motion.exact, 0.0);
  for (std::size_t k = 0; k < motion.t.size(); ++k) {
    EXPECT_NEAR(found[k].position, motion.exact[k], 2e-6) << motion.t[k];
  }
}

TEST(SmoothMotion, FindsTheVelocityFromUnevenStamps) {
  std::vector<double> t, position;
  Random random(3);
  for (double at = 0.0; at < 2.0; at += random.uniform(0.001, 0.012)) {
    t.push_back(at);
    position.push_back(0.02 * at + kTipNoise * random.normal());
  }
  const std::vector<MotionSample> found = smooth_motion(t, position, kTipNoise);
  EXPECT_NEAR(found[found.size() / 2].velocity, 0.02, 4e-4);
}

}  // namespace
}  // namespace pcavr
