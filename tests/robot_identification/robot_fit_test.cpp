// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/robot_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/robots/robot_identification/replay_motion.hpp"

#include "robot_identification/simulated_arm.hpp"

namespace pcavr {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

TEST(FitRobot, RecoversThePa10sFrictionFromNoisyTorques) {
  const RobotModel model = pa10();
  const JointSignals signals = joint_signals(simulated_log(model, {.duration = 60.0}), {});
  const RobotFit fit = fit_robot(signals, model, {});
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    const PlantFriction truth = plant_friction(static_cast<Eigen::Index>(j));
    const JointFit& joint = fit.joints[j];
    EXPECT_NEAR(joint.value_of(FrictionTerm::viscous), truth.viscous, 0.02 * truth.viscous)
        << joint.name;
    EXPECT_NEAR(joint.value_of(FrictionTerm::coulomb), truth.coulomb, 0.02 * truth.coulomb)
        << joint.name;
  }
}

// The terms may be others, the curve is the same.
TEST(FitRobot, StatesThreeParametersThatDoNotDependOnTheTerms) {
  const RobotModel model = pa10();
  const JointSignals signals = joint_signals(simulated_log(model, {.duration = 60.0}), {});
  RobotFitOptions plain;
  plain.is_extended = false;
  const RobotFit extended_fit = fit_robot(signals, model, {});
  const RobotFit plain_fit = fit_robot(signals, model, plain);
  for (std::size_t j = 0; j < extended_fit.joints.size(); ++j) {
    const std::vector<FittedTerm>& found = extended_fit.joints[j].equivalent;
    const std::vector<FittedTerm>& expected = plain_fit.joints[j].equivalent;
    ASSERT_EQ(found.size(), 3U);
    for (const std::size_t k : {1U, 2U}) {
      EXPECT_NEAR(found[k].value, expected[k].value, 0.04 * expected[k].value) << j;
      EXPECT_GT(found[k].std, 0.0) << j;
    }
  }
}

TEST(FitRobot, LeavesOutEachStretchOfTheFittedPart) {
  const RobotModel model = pa10();
  const JointSignals signals = joint_signals(simulated_log(model), {});
  const RobotFit fit = fit_robot(signals, model, {});
  ASSERT_EQ(fit.left_out.size(), 5U);
  EXPECT_EQ(fit.left_out.front().begin, signals.t.front());
  EXPECT_NEAR(fit.left_out.back().end, signals.t[fit.train_rows - 1], 0.1);
  for (const LeftOutFit& left_out : fit.left_out) {
    EXPECT_GT((left_out.inertial_parameters - fit.inertial_parameters).norm(), 0.0);
    EXPECT_EQ(left_out.joints[3].friction.size(), fit.joints[3].friction.size());
  }
}

TEST(FitRobot, FitsPossibleBodiesAndReplaysTheMotion) {
  const RobotModel model = pa10();
  // The instants of reversals are less certain at 200 Hz: 0.8 degrees.
  const JointLog log = simulated_log(model, {.duration = 60.0, .rate = 500.0});
  const JointSignals signals = joint_signals(log, {});
  const RobotFit fit = fit_robot(signals, model, {});
  EXPECT_TRUE(fit.is_physical);
  const MotionReplay replay = replay_motion(log, signals, fit, model, fit.train_rows, 1.2);
  ASSERT_TRUE(replay.simulated.is_finite);
  EXPECT_LT(replay.after_1s.maxCoeff() * kDegrees, 0.5);
}

// Paper A's figure 3 is of one moving joint, the others braked. Joints 2 and 4 carry the arm's
// weight, and leave the record as an inverted pendulum does.
TEST(ReplayMotion, HoldsJointsThatCarryNoWeightForFiveSecondsWhereTheOthersFollowTheRecord) {
  const RobotModel model = pa10();
  const JointLog log = simulated_log(model, {.duration = 60.0, .rate = 500.0, .seed = 2301});
  const JointSignals signals = joint_signals(log, {});
  const RobotFit fit = fit_robot(signals, model, {});
  const MotionReplay replay = replay_motion(log, signals, fit, model, fit.train_rows, 5.0);
  ASSERT_TRUE(replay.alone.is_finite);
  for (const Eigen::Index joint : {0, 2, 4, 5, 6}) {
    EXPECT_LT(replay.alone.rms[joint] * kDegrees, 1.0) << joint;
    EXPECT_GT(replay.alone.kept[joint], 4.9) << joint;
  }
  EXPECT_LT(replay.simulated.kept.minCoeff(), 4.0) << "all joints together are held as long";
}

TEST(ReplayMotion, StatesTheTorqueErrorThatMovesAJointByThreeDegrees) {
  constexpr double kDuration = 1.5;  // [s]
  const RobotModel model = pa10();
  JointLog log = simulated_log(model, {.duration = 40.0});
  const JointSignals signals = joint_signals(log, {});
  const RobotFit fit = fit_robot(signals, model, {});
  const auto replayed = [&] {
    return replay_motion(log, signals, fit, model, fit.train_rows, kDuration);
  };
  const MotionReplay as_recorded = replayed();
  for (const Eigen::Index joint : {0, 1, 3, 6}) {
    log.torque.col(joint).array() += as_recorded.tolerable_torque[joint];
    const Eigen::MatrixXd moved = replayed().simulated.position - as_recorded.simulated.position;
    log.torque.col(joint).array() -= as_recorded.tolerable_torque[joint];
    const double rms =
        (moved.colwise().squaredNorm() / double(moved.rows())).cwiseSqrt().maxCoeff();
    EXPECT_NEAR(rms * kDegrees, 3.0, 1.0) << joint;
  }
}

TEST(FitRobot, FitsFrictionAloneOnAKnownBody) {
  const RobotModel model = pa10();
  RobotFitOptions options;
  options.known_body = true;
  const RobotFit fit = fit_robot(joint_signals(simulated_log(model), {}), model, options);
  EXPECT_LT((fit.inertial_parameters - inertial_parameters(model)).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NEAR(fit.joints[1].value_of(FrictionTerm::coulomb), plant_friction(1).coulomb,
              0.05 * plant_friction(1).coulomb);
}

TEST(FitRobot, IsNotMovedByOutliers) {
  const RobotModel model = pa10();
  JointLog log = simulated_log(model);
  Random random(8);
  for (int k = 0; k < 60; ++k) {
    const auto row = static_cast<Eigen::Index>(random.below(3500));
    log.torque.row(row).array() += 40.0;
  }
  const RobotFit fit = fit_robot(joint_signals(log, {}), model, {});
  EXPECT_NEAR(fit.joints[0].value_of(FrictionTerm::coulomb), plant_friction(0).coulomb,
              0.08 * plant_friction(0).coulomb);
}

TEST(FitRobot, NamesWhatAMotionOfOneJointDoesNotExcite) {
  const RobotModel model = pa10();
  JointLog log = simulated_log(model);
  for (Eigen::Index j = 0; j < 7; ++j) {
    if (j != 1) log.position.col(j).setZero();
  }
  const RobotFit fit = fit_robot(joint_signals(log, {}), model, {});
  const auto weak = std::count_if(fit.base_parameters.begin(), fit.base_parameters.end(),
                                  [](const BaseParameter& entry) { return !entry.is_excited; });
  EXPECT_GT(weak, 20);
}

TEST(FitRobot, HasFortyThreeBaseParametersForThePa10) {
  const RobotModel model = pa10();
  const RobotFit fit = fit_robot(joint_signals(simulated_log(model), {}), model, {});
  EXPECT_EQ(fit.base_parameters.size(), 43U);
}

TEST(FitRobot, StatesStdsThatTheHalvesOfALogConfirm) {
  const RobotModel model = pa10();
  RobotFitOptions options;
  options.train_share = 1.0;
  const JointLog log = simulated_log(model, {.duration = 80.0});
  std::vector<RobotFit> halves;
  for (const Eigen::Index first : {Eigen::Index{0}, log.position.rows() / 2}) {
    JointLog half = log;
    const Eigen::Index count = log.position.rows() / 2;
    half.position = log.position.middleRows(first, count);
    half.torque = log.torque.middleRows(first, count);
    const auto from = static_cast<std::ptrdiff_t>(first),
               to = from + static_cast<std::ptrdiff_t>(count);
    half.t.assign(log.t.begin() + from, log.t.begin() + to);
    half.stamps.assign(log.stamps.begin() + from, log.stamps.begin() + to);
    half.lines.assign(log.lines.begin() + from, log.lines.begin() + to);
    halves.push_back(fit_robot(joint_signals(half, {}), model, options));
  }
  int count = 0, within_two = 0;
  for (std::size_t k = 0; k < halves[0].base_parameters.size(); ++k) {
    const BaseParameter& a = halves[0].base_parameters[k];
    const BaseParameter& b = halves[1].base_parameters[k];
    if (!a.is_excited || !b.is_excited) continue;
    ++count;
    if (std::abs(a.value - b.value) < 2.0 * std::hypot(a.std, b.std)) ++within_two;
  }
  EXPECT_GE(count, 30);
  EXPECT_GE(within_two, 9 * count / 10);
}

}  // namespace
}  // namespace pcavr
