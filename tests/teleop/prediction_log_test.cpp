// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/prediction_log.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

Prediction prediction_at(double x, double yaw, double force) {
  Prediction prediction;
  prediction.pose = {x, -x, yaw};
  prediction.force_base.x() = force;
  prediction.rendered_force_base.x() = 2.0 * force;
  return prediction;
}

// A slide at 0.1 m/s whose commands are lost for 20 ms must not look like an error of 2 mm.
TEST(PredictionLog, HasWhatLostCommandsWouldHaveStated) {
  constexpr double kCycle = 0.001;
  PredictionLog log(1.0, kCycle, 2);
  log.append_after(3, {prediction_at(0.0, 0.0, 0.0), prediction_at(7.0, 0.0, 5.0)});
  EXPECT_EQ(log.at(1.001, 1).pose.x, 7.0);  // nothing was before
  log.append_after(20, {prediction_at(0.002, 0.04, 10.0), prediction_at(7.0, 0.0, 5.0)});
  const Prediction& lost = log.at(1.003 + 5.0 * kCycle, 0);
  EXPECT_NEAR(lost.pose.x, 0.0005, 1e-12);
  EXPECT_NEAR(lost.pose.y, -0.0005, 1e-12);
  EXPECT_NEAR(lost.pose.yaw, 0.01, 1e-12);
  EXPECT_NEAR(lost.force_base.x(), 2.5, 1e-12);
  EXPECT_NEAR(lost.rendered_force_base.x(), 5.0, 1e-12);
  EXPECT_EQ(log.at(1.010, 1).pose.x, 7.0);
  EXPECT_EQ(log.at(1.023, 0).pose.x, 0.002);
}

TEST(PredictionLog, TurnsTheShorterWayBetweenCommands) {
  PredictionLog log(0.0, 0.001, 1);
  log.append_after(1, {prediction_at(0.0, M_PI - 0.02, 0.0)});
  log.append_after(2, {prediction_at(0.0, -M_PI + 0.02, 0.0)});
  EXPECT_NEAR(std::abs(log.at(0.002, 0).pose.yaw), M_PI, 1e-12);
}

}  // namespace
}  // namespace pcavr
