// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

/// A run in which a body rests for ten seconds, slides along x at 30 mm/s for ten, and the tool
/// presses with 5 N along y all the time.
PlantRun a_run() {
  PlantRun run;
  run.bodies.resize(1);
  for (int i = 0; i <= 20000; ++i) {
    const double t = PlantRun::kStep * i;
    run.p_base_tip.emplace_back(0.1, 0.2, 0.3);
    run.force_base.emplace_back(0.0, 5.0, 0.0);
    run.torque_base.emplace_back(0.0, 0.0, 0.0);
    PlantBodyState state;
    state.p_base.x() = t > 10.0 ? 0.03 * (t - 10.0) : 0.0;
    run.bodies[0].push_back(state);
  }
  return run;
}

PlantBody a_body() {
  PlantBody body;
  body.T_base_object = Pose::from_translation({0.0, 0.0, 0.05});
  return body;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(Sensors, TheToolIsReportedAt500HzWithItsNoise) {
  const Trajectory tool = measured_tool(a_run(), 1);
  ASSERT_EQ(tool.size(), 10001U);
  double squares = 0.0;
  for (const TimedPose& timed : tool.poses()) {
    squares += (timed.pose.translation() - Eigen::Vector3d(0.1, 0.2, 0.3)).squaredNorm();
  }
  // 30000 draws estimate the std to 0.5 %.
  EXPECT_NEAR(std::sqrt(squares / 3.0 / 10001.0), 5e-5, 1e-6);
}

TEST(Sensors, TheWrenchHasNoiseDriftAndSpikes) {
  const std::vector<WrenchSample> wrench = measured_wrench(a_run(), 1);
  ASSERT_EQ(wrench.size(), 10000U);
  EXPECT_EQ(wrench[0].stamp.nanoseconds, 1'000'000);
  EXPECT_EQ(wrench[1].stamp.nanoseconds, 3'000'000);
  std::vector<double> off;
  std::vector<double> steps;
  int spikes = 0;
  for (std::size_t i = 0; i < wrench.size(); ++i) {
    off.push_back(std::abs(wrench[i].force.y() - 5.0));
    if (i > 0) steps.push_back(std::abs(wrench[i].force.y() - wrench[i - 1].force.y()));
    spikes += (wrench[i].force - Eigen::Vector3d(0.0, 5.0, 0.0)).norm() > 4.0 ? 1 : 0;
  }
  // Neighbours differ by sqrt(2) 0.2 N of noise; the median of a normal's magnitude is 0.674 sigma.
  EXPECT_NEAR(median(steps), 0.674 * std::numbers::sqrt2 * 0.2, 0.01);
  EXPECT_LT(median(off), 0.674 * 0.5);
  // 10 expected, Poisson.
  EXPECT_GE(spikes, 2);
  EXPECT_LE(spikes, 24);
}

TEST(Sensors, FaultsHaveTheirEffect) {
  const PlantRun run = a_run();
  const auto plain = measured_wrench(run, 1);
  const auto late = measured_wrench(run, 1, {.clock_offset = 0.1});
  EXPECT_EQ(late[0].stamp.nanoseconds, 101'000'000);
  EXPECT_EQ(late[0].force, plain[0].force);
  const auto early = measured_wrench(run, 1, {.clock_offset = -0.1});
  EXPECT_GE(early[0].stamp.nanoseconds, 0);
  EXPECT_EQ(early.size(), plain.size() - 50);
  const auto flipped = measured_wrench(run, 1, {.is_force_flipped = true});
  EXPECT_EQ(flipped[7].force, Eigen::Vector3d(-plain[7].force));
  SensorFaults saturated;
  saturated.saturation = 4.0;
  for (const WrenchSample& sample : measured_wrench(run, 1, saturated)) {
    EXPECT_LE(sample.force.cwiseAbs().maxCoeff(), 4.0);
  }
}

TEST(Sensors, ACablePullsTheToolBackToWhereItStarted) {
  PlantRun run = a_run();
  for (std::size_t i = 10000; i < run.p_base_tip.size(); ++i) run.p_base_tip[i].x() += 0.2;
  const auto plain = measured_wrench(run, 1);
  SensorFaults faults;
  faults.cable_stiffness = 2.0;
  const auto pulled = measured_wrench(run, 1, faults);
  EXPECT_EQ(pulled[100].force, plain[100].force);
  EXPECT_NEAR(pulled[9000].force.x() - plain[9000].force.x(), 0.4, 1e-9);
  EXPECT_EQ(pulled[9000].force.y(), plain[9000].force.y());
}

TEST(Sensors, LateTrackingHasTheSamePosesUnderLaterStamps) {
  SensorFaults late;
  late.tracking_delay = 0.05;
  const auto plain = simulated_tracking(a_run(), a_body(), 0, 1);
  const auto delayed = simulated_tracking(a_run(), a_body(), 0, 1, late);
  ASSERT_EQ(plain.size(), delayed.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_NEAR(to_seconds(delayed[i].stamp - plain[i].stamp), 0.05, 1e-9);
    EXPECT_EQ(delayed[i].T_base_object.translation(), plain[i].T_base_object.translation());
  }
}

TEST(Sensors, TrackingIsNearlyConstantAtRestAndNoisyInMotion) {
  const PlantRun run = a_run();
  const PlantBody body = a_body();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<double> rest;
    std::vector<double> motion;
    for (const SimulatedMeasurement& measurement : simulated_tracking(run, body, 0, seed)) {
      const Pose truth = T_base_object_at(run, body, 0, measurement.stamp.seconds());
      const double off = translation_distance(truth, measurement.T_base_object);
      if (measurement.stamp.seconds() < 10.0) {
        EXPECT_TRUE(measurement.is_at_rest);
        rest.push_back(off);
      } else if (measurement.stamp.seconds() > 10.2) {
        EXPECT_FALSE(measurement.is_at_rest);
        motion.push_back(off);
      }
    }
    EXPECT_GT(median(rest), 4e-5) << seed;
    EXPECT_LT(median(rest), 1.8e-4) << seed;
    EXPECT_LT(*std::max_element(rest.begin(), rest.end()), 3e-4) << seed;
    // 0.3 mm rms over three axes: a median of 0.27 mm.
    EXPECT_NEAR(median(motion), 2.7e-4, 4e-5) << seed;
    EXPECT_LT(*std::max_element(motion.begin(), motion.end()), 2.5e-3) << seed;
  }
}

TEST(Sensors, AnObjectThatIsLostIsNotSeen) {
  SensorFaults faults;
  faults.lost_tracking = {.begin = 3.0, .end = 4.0};
  int lost = 0;
  for (const SimulatedMeasurement& measurement :
       simulated_tracking(a_run(), a_body(), 0, 1, faults)) {
    const double t = measurement.stamp.seconds();
    EXPECT_EQ(measurement.is_seen, t < 3.0 || t > 4.0) << t;
    lost += measurement.is_seen ? 0 : 1;
  }
  EXPECT_NEAR(lost, 30, 1);
}

}  // namespace
}  // namespace pcavr
