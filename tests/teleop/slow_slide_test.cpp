// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/slow_slide.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr double kFrame = 1.0 / 30.0;  // [s]
constexpr double kNoise = 1e-4;        // [m]

SlowSlide::Frame frame_at(double t, double body, double tip, Random& random) {
  return {t, body + kNoise * random.normal(), kNoise, tip};
}

TEST(SlowSlide, IsFoundWithItsOnsetAndItsEnd) {
  for (const double speed : {0.001, 0.0025, 0.01}) {
    Random random(3);
    SlowSlide slide(0.5, 3e-4);
    slide.restart(0.0);
    double found = 0.0, ended = 0.0;
    for (double t = 0.0; t < 8.0; t += kFrame) {
      const double body = speed * std::clamp(t - 1.0, 0.0, 4.0);
      slide.add(frame_at(t, body, body, random));
      const auto onset = slide.onset();
      if (onset && found == 0.0) {
        found = t;
        EXPECT_NEAR(*onset, 1.0, 0.3) << speed;
      }
      if (found > 0.0 && ended == 0.0 && slide.is_at_rest()) ended = t;
    }
    EXPECT_GT(found, 1.0) << speed;
    EXPECT_LT(found, 2.5) << speed;
    if (speed >= 0.0025) {
      EXPECT_GT(ended, 5.0) << speed;
      EXPECT_LT(ended, 5.8) << speed;
    }
  }
}

TEST(SlowSlide, IsNoNoiseNoStepAndNoMotionThatTheTipDoesNotMake) {
  Random random(4);
  SlowSlide noise(0.5, 3e-4), step(0.5, 3e-4), alone(0.5, 3e-4);
  for (double t = 0.0; t < 60.0; t += kFrame) {
    noise.add(frame_at(t, 0.0, 0.0025 * t, random));
    EXPECT_FALSE(noise.onset()) << t;
    step.add(frame_at(t, t < 2.0 ? 0.0 : 0.002, 0.0025 * t, random));
    EXPECT_FALSE(step.onset()) << t;
    alone.add(frame_at(t, 0.0025 * t, 0.0, random));
    EXPECT_FALSE(alone.onset()) << t;
  }
}

}  // namespace
}  // namespace pcavr
