// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/joint_signals.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {
namespace {

Eigen::VectorXd sine(double frequency, double rate, Eigen::Index count) {
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    values[i] = std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(i) / rate);
  }
  return values;
}

TEST(ZeroPhaseFilter, LeavesASlowSineWhereItIsAndHalvesOneAtTheBandwidth) {
  const Eigen::VectorXd slow = sine(1.0, 500.0, 4000), edge = sine(10.0, 500.0, 4000);
  const Eigen::VectorXd kept = filter_zero_phase(slow, 500.0, 10.0);
  const Eigen::VectorXd halved = filter_zero_phase(edge, 500.0, 10.0);
  EXPECT_LT((kept - slow).segment(500, 3000).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((halved - 0.5 * edge).segment(500, 3000).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ZeroPhaseFilter, KeepsAStraightLineUpToItsEnds) {
  const Eigen::VectorXd line = Eigen::VectorXd::LinSpaced(400, -1.0, 3.0);
  // A hundred-thousandth of its range of 4: what is left of the start at the continued end.
  EXPECT_LT((filter_zero_phase(line, 100.0, 5.0) - line).cwiseAbs().maxCoeff(), 4e-5);
}

TEST(Differentiate, IsExactToAThousandthAtATenthOfTheRate) {
  const Eigen::VectorXd rate = differentiate(sine(10.0, 100.0, 200), 0.01);
  for (Eigen::Index i = 10; i < 190; ++i) {
    const double t = 0.01 * static_cast<double>(i), w = 2.0 * std::numbers::pi * 10.0;
    EXPECT_NEAR(rate[i], w * std::cos(w * t), 1e-3 * w) << i;
  }
}

TEST(Interpolate, HitsItsKnotsAndFollowsASineBetween) {
  const std::vector<double> t{0.0, 0.1, 0.25, 0.3, 0.4};
  Eigen::VectorXd values(5);
  for (Eigen::Index i = 0; i < 5; ++i) values[i] = std::sin(t[static_cast<std::size_t>(i)]);
  const Eigen::VectorXd at = interpolate(t, values, {0.0, 0.25, 0.28, 0.4});
  EXPECT_DOUBLE_EQ(at[0], values[0]);
  EXPECT_DOUBLE_EQ(at[1], values[2]);
  EXPECT_NEAR(at[2], std::sin(0.28), 2e-4);
  EXPECT_DOUBLE_EQ(at[3], values[4]);
}

JointLog two_sines(double velocity_lag) {
  JointLog log;
  log.joints = {"1", "2"};
  const Eigen::Index rows = 4000;
  log.position.resize(rows, 2);
  log.velocity.resize(rows, 2);
  log.torque.setZero(rows, 2);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = 0.002 * static_cast<double>(i), late = t - velocity_lag;
    log.t.push_back(t);
    log.stamps.push_back(Stamp::from_seconds(t));
    log.lines.push_back(static_cast<int>(i) + 2);
    log.position.row(i) << std::sin(3.0 * t), 0.5 * std::cos(5.0 * t);
    log.velocity.row(i) << 3.0 * std::cos(3.0 * late), -2.5 * std::sin(5.0 * late);
  }
  return log;
}

TEST(JointSignals, FiltersSignsOfSpeedsAsTheTorques) {
  JointLog log = two_sines(0.0);
  for (Eigen::Index i = 0; i < log.torque.rows(); ++i) {
    log.torque(i, 0) = std::tanh(log.velocity(i, 0) / 0.01);
  }
  const JointSignals signals = joint_signals(log, {});
  const Eigen::VectorXd sign =
      friction_sign({.smoothing_speed = 0.01, .is_filtered = true}, signals, 0);
  const Eigen::VectorXd of_speed = friction_sign({.smoothing_speed = 0.01}, signals, 0);
  EXPECT_LT((sign - signals.torque.col(0)).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_GT((of_speed - signals.torque.col(0)).cwiseAbs().maxCoeff(), 0.3);
}

TEST(JointSignals, EstimatesTheDelayOfRecordedVelocities) {
  const JointSignals signals = joint_signals(two_sines(0.006), {});
  EXPECT_NEAR(signals.velocity_lag, 0.006, 1e-4);
  EXPECT_LT(signals.velocity_disagreement.value(), 1e-3);
}

TEST(JointSignals, LeavesOutTheSurroundingsOfAGap) {
  JointLog log = two_sines(0.0);
  for (std::size_t i = 2000; i < log.t.size(); ++i) log.t[i] += 0.5;
  const JointSignals signals = joint_signals(log, {});
  for (const double t : signals.t) EXPECT_TRUE(t < 3.998 || t > 4.5) << t;
}

TEST(JointSignals, LeavesOutRest) {
  JointLog log = two_sines(0.0);
  log.velocity.resize(0, 0);
  for (Eigen::Index i = 0; i < 1500; ++i) log.position.row(i) = log.position.row(1500);
  EXPECT_GT(joint_signals(log, {}).rows_at_rest, 1300U);
}

}  // namespace
}  // namespace pcavr
