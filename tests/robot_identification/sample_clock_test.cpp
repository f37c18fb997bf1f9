// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/sample_clock.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

/// A state of 1 kHz, read each 1.02 ms on average with jitter.
JointLog read_out_of_step(double jitter) {
  JointLog log;
  log.joints = {"1", "2"};
  const Eigen::Index rows = 5000;
  log.position.resize(rows, 2);
  log.velocity.resize(rows, 2);
  log.torque.setZero(rows, 2);
  Random random(5);
  double t = 0.0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double cycle = jitter > 0.0 ? 1e-3 * std::floor(t / 1e-3) : t;
    log.t.push_back(t);
    log.stamps.push_back(Stamp::from_seconds(t));
    log.lines.push_back(static_cast<int>(i) + 2);
    log.position.row(i) << std::sin(2.0 * cycle), 0.7 * std::cos(3.0 * cycle);
    log.velocity.row(i) << 2.0 * std::cos(2.0 * cycle), -2.1 * std::sin(3.0 * cycle);
    t += 1.02e-3 + jitter * random.uniform(-1.0, 1.0);
  }
  return log;
}

TEST(SampleClock, RecoversTheCycleOfAControllerReadOutOfStep) {
  JointLog log = read_out_of_step(3e-4);
  const SampleClock clock = correct_sample_clock(log);
  EXPECT_TRUE(clock.is_corrected);
  EXPECT_NEAR(clock.tick, 1e-3, 1e-6);
  EXPECT_GT(clock.repeated, 50U);
  double error = 0.0;
  for (std::size_t i = 0; i < log.t.size(); ++i) {
    const double offset = log.position(static_cast<Eigen::Index>(i), 0) - std::sin(2.0 * log.t[i]);
    error = std::max(error, std::abs(offset));
  }
  EXPECT_LT(error, 1.2e-3) << "half a cycle at 2 rad/s, and the phase of the first row";
}

TEST(SampleClock, LeavesALogWithExactStampsAlone) {
  JointLog log = read_out_of_step(0.0);
  const std::vector<double> before = log.t;
  EXPECT_FALSE(correct_sample_clock(log).is_corrected);
  EXPECT_EQ(log.t, before);
}

}  // namespace
}  // namespace pcavr
