// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/friction_trial.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/robots/robot_identification/friction_intervals.hpp"

#include "robot_identification/simulated_arm.hpp"

namespace pcavr {
namespace {

/// A PA-10 whose bodies are known [paper A].
struct KnownArm {
  RobotModel model = pa10();
  JointSignals signals;
  RobotFit fit;

  explicit KnownArm(const JointLog& log) : signals(joint_signals(log, {})) {
    RobotFitOptions options;
    options.known_body = true;
    fit = fit_robot(signals, model, options);
  }
};

FrictionTrialOptions few_stretches() {
  FrictionTrialOptions options;
  options.stretch = 0.5;
  options.stretches = 4;
  return options;
}

// The split between viscous and Coulomb friction is known less well than their sum at the speeds of
// the motion: 12 % against 3 % on the whole command's ten stretches of a second.
TEST(TryFriction, FindsAPa10sFrictionAtItsSpeedsAndWorseThanTheRegression) {
  const KnownArm arm(simulated_log(pa10(), {.seed = 5}));
  const auto trial = try_friction(arm.signals, arm.model, arm.fit, few_stretches());
  ASSERT_TRUE(trial.has_value());
  for (Eigen::Index j = 0; j < 7; ++j) {
    const PlantFriction truth = plant_friction(j);
    const auto index = static_cast<std::size_t>(j);
    const double speed = std::sqrt(arm.signals.velocity.col(j).squaredNorm() /
                                   static_cast<double>(arm.signals.velocity.rows()));
    const double expected = truth.viscous * speed + truth.coulomb;
    for (const TrialStage* stage : {&trial->alone, &trial->together}) {
      const JointFit& joint = stage->joints[index];
      EXPECT_NEAR(
          joint.value_of(FrictionTerm::viscous) * speed + joint.value_of(FrictionTerm::coulomb),
          expected, 0.06 * expected)
          << j;
      EXPECT_GE(joint.held_out.relative, arm.fit.joints[index].held_out.relative) << j;
      EXPECT_LT(joint.held_out.relative, 0.15) << j;
    }
  }
}

TEST(TryFriction, TriesViscousFrictionAloneWhereAsked) {
  const KnownArm arm(simulated_log(pa10(), {.duration = 15.0, .seed = 6}));
  FrictionTrialOptions options = few_stretches();
  options.stretches = 2;
  options.is_viscous_only = true;
  const auto trial = try_friction(arm.signals, arm.model, arm.fit, options);
  ASSERT_TRUE(trial.has_value());
  EXPECT_EQ(trial->together.joints[0].value_of(FrictionTerm::coulomb), 0.0);
  EXPECT_GT(trial->together.joints[0].value_of(FrictionTerm::viscous), plant_friction(0).viscous);
  options.stretch = 60.0;
  EXPECT_FALSE(try_friction(arm.signals, arm.model, arm.fit, options).has_value());
}

// Coulomb friction of joint 1 is 2 N m higher beyond the middle of its range.
TEST(FrictionByInterval, ShowsFrictionThatDiffersByPosition) {
  JointLog log = simulated_log(pa10(), {.duration = 40.0, .seed = 7});
  const double middle = 0.5 * (log.position.col(0).minCoeff() + log.position.col(0).maxCoeff());
  for (Eigen::Index i = 1; i + 1 < log.torque.rows(); ++i) {
    const double moved = log.position(i + 1, 0) - log.position(i - 1, 0);
    if (log.position(i, 0) > middle) log.torque(i, 0) += std::copysign(2.0, moved);
  }
  const KnownArm arm(log);
  const std::vector<JointIntervals> found = friction_by_interval(arm.signals, arm.model, arm.fit);
  const JointIntervals& joint = found.front();
  ASSERT_EQ(joint.intervals.size(), 6U);
  const double coulomb = plant_friction(0).coulomb;
  EXPECT_NEAR(joint.intervals[1].terms[2].value, coulomb, 0.1 * coulomb);
  EXPECT_NEAR(joint.intervals[4].terms[2].value, coulomb + 2.0, 0.1 * coulomb);
  EXPECT_LT(joint.held_out.relative, 0.8 * arm.fit.joints.front().held_out.relative);
  // The table does no harm where friction does not differ.
  EXPECT_LT(found[3].held_out.relative, 1.05 * arm.fit.joints[3].held_out.relative);
}

}  // namespace
}  // namespace pcavr
