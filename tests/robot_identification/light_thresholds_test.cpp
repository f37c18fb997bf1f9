// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot_identification/light_thresholds.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kInterval = 0.01, kSpeed = 0.5;
constexpr int kRows = 6000, kFirstJudged = 4000;

/// One joint, 60 s at 100 Hz: back and forth at a speed that changes its sign at once, so that no
/// row is slow, with errors of 1 N m of either sign, 2 in a second.
struct OneJoint {
  JointLog log;
  Eigen::MatrixXd velocity = Eigen::MatrixXd::Zero(kRows, 1);
  ObservedRows without{kRows, 1}, judged{kRows, 1};
  Eigen::MatrixXd coulomb = Eigen::MatrixXd::Constant(kRows, 1, 0.5);

  OneJoint() {
    log.position.resize(kRows, 1);
    for (int i = 0; i < kRows; ++i) {
      const double t = kInterval * i;
      log.t.push_back(t);
      const bool is_forth = std::fmod(t, 4.0) < 2.0;
      velocity(i, 0) = is_forth ? kSpeed : -kSpeed;
      log.position(i, 0) = kSpeed * (is_forth ? std::fmod(t, 2.0) : 2.0 - std::fmod(t, 2.0));
      without.filtered(i, 0) = std::fmod(t, 1.0) < 0.5 ? 1.0 : -1.0;
      without.age[static_cast<std::size_t>(i)] = judged.age[static_cast<std::size_t>(i)] = 10.0;
    }
  }
  [[nodiscard]] LightThresholds thresholds(std::size_t first_judged = kFirstJudged) const {
    return light_thresholds({log, velocity, without, judged, coulomb, first_judged}, {});
  }
  /// Slow from 1 s on in each 4 s, for half a second.
  void slow_down() {
    for (int i = 0; i < kRows; ++i) {
      const double phase = std::fmod(kInterval * i, 4.0);
      if (phase >= 1.0 && phase < 1.5) velocity(i, 0) = 0.02;
    }
  }
};

/// [N m/(N m)] of the default spacing of false alarms.
double margin(double errors) { return std::sqrt(std::log(1e6) / std::log(errors)); }

TEST(LightThresholds, AreTheLargestErrorWithAMarginForItsCount) {
  OneJoint joint;
  EXPECT_NEAR(joint.thresholds().threshold(5000, 0), margin(80), 1e-9);
  // Half the rows have half as many errors, which show less of how large they become.
  EXPECT_NEAR(joint.thresholds(kFirstJudged / 2).threshold(5000, 0), margin(40), 1e-9);
}

TEST(LightThresholds, AreApartForASlowJointAndNotBelowCoulombFriction) {
  OneJoint joint;
  joint.slow_down();
  const double moving = joint.thresholds().threshold(5390, 0);
  for (int i = 0; i < kFirstJudged; ++i) {
    if (joint.velocity(i, 0) == 0.02) joint.without.filtered(i, 0) *= 4.0;
  }
  const LightThresholds found = joint.thresholds();
  EXPECT_DOUBLE_EQ(found.threshold(5390, 0), moving);
  EXPECT_GT(found.threshold(5320, 0), 4.0 * moving);
  // The filters remember the slow motion for a while.
  EXPECT_DOUBLE_EQ(found.threshold(5350 + 30, 0), found.threshold(5320, 0));
  joint.coulomb.setConstant(50.0);
  EXPECT_DOUBLE_EQ(joint.thresholds().threshold(5320, 0), 50.0);
  EXPECT_DOUBLE_EQ(joint.thresholds().threshold(5390, 0), moving);
}

TEST(LightThresholds, AreInfiniteOutsideThePositionsAndSpeedsWithoutContact) {
  OneJoint joint;
  joint.log.position(5000, 0) = 1.2;
  joint.velocity(5500, 0) = -0.6;
  const LightThresholds found = joint.thresholds();
  for (const int row : {5000, 5020, 5500, 5520}) {
    EXPECT_TRUE(std::isinf(found.threshold(row, 0))) << row;
  }
  EXPECT_TRUE(std::isfinite(found.threshold(4990, 0)));
  EXPECT_TRUE(std::isfinite(found.threshold(5050, 0)));
}

TEST(LightThresholds, AreInfiniteWhereFewErrorsWereSeen) {
  OneJoint joint;
  for (double& age : joint.without.age) age = 0.0;
  for (std::size_t row = 100; row < 500; ++row) joint.without.age[row] = 10.0;  // 8 errors
  EXPECT_TRUE(std::isinf(joint.thresholds().threshold(5000, 0)));
  EXPECT_TRUE(std::isinf(joint.thresholds(0).threshold(5000, 0)));
}

TEST(LightThresholds, TakeOffWhatTheSamplesResolveLessThanWithoutContact) {
  OneJoint joint;
  joint.without.filtered_unresolved.setConstant(0.3);
  joint.judged.filtered.setConstant(-2.0);
  joint.judged.filtered_unresolved.setConstant(0.2);
  joint.judged.filtered_unresolved(5000, 0) = 1.0;
  const LightThresholds found = joint.thresholds();
  EXPECT_DOUBLE_EQ(found.torque(4999, 0), 2.0);
  EXPECT_DOUBLE_EQ(found.torque(5000, 0), 2.0 - 0.7);
}

}  // namespace
}  // namespace pcavr
