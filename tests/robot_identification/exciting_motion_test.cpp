// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/exciting_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "robot_identification/simulated_arm.hpp"

namespace pcavr {
namespace {

/// A poor first log: slow motions about one posture.
RobotFit poor_fit(const RobotModel& model, std::uint64_t seed, JointSignals& signals) {
  SimulatedLogOptions options{.duration = 20.0, .seed = seed};
  options.amplitude_share = 0.2;
  signals = joint_signals(simulated_log(model, options), {});
  return fit_robot(signals, model, {});
}

double std_of(const JointFit& joint, FrictionTerm wanted) {
  for (const FittedTerm& term : joint.friction) {
    if (term.term == wanted) return term.std;
  }
  return 0.0;
}

TEST(ExcitingMotion, ReachesTheStdsThatItPredictsAndStaysWithinBounds) {
  const RobotModel model = pa10();
  JointSignals signals;
  const RobotFit before = poor_fit(model, 4, signals);
  ExcitingMotionOptions options;
  options.extra_range = 0.8;
  options.candidates = 60;  // for the test's time
  const ExcitingMotion motion = plan_exciting_motion(signals, model, before, options);
  for (Eigen::Index j = 0; j < motion.position.cols(); ++j) {
    const JointLimits& limits = model.joints[static_cast<std::size_t>(j)].limits;
    EXPECT_GE(motion.position.col(j).minCoeff(), *limits.lower);
    EXPECT_LE(motion.position.col(j).maxCoeff(), *limits.upper);
    EXPECT_NEAR(motion.position(1, j), motion.position(0, j), 1e-4) << "begins at rest";
    const Eigen::Index last = motion.position.rows() - 1;
    EXPECT_NEAR(motion.position(last, j), motion.position(last - 1, j), 1e-4) << "ends at rest";
  }
  const JointLog log = simulated_log_along(model, motion.position, 0.01, {});
  const RobotFit after = fit_robot(joint_signals(log, {}), model, {});
  for (std::size_t j = 0; j < after.joints.size(); ++j) {
    EXPECT_LT(std_of(after.joints[j], FrictionTerm::viscous), 1.5 * motion.viscous_std[j]) << j;
    EXPECT_LT(std_of(after.joints[j], FrictionTerm::coulomb), 1.5 * motion.coulomb_std[j]) << j;
    EXPECT_LT(motion.viscous_std[j], std_of(before.joints[j], FrictionTerm::viscous)) << j;
  }
  double improvement = 0.0;
  for (std::size_t i = 0; i < after.base_parameters.size(); ++i) {
    EXPECT_LT(after.base_parameters[i].std, 1.5 * motion.base_parameters[i].std)
        << after.base_parameters[i].name;
    improvement += std::log(after.base_parameters[i].std / before.base_parameters[i].std);
  }
  EXPECT_LT(improvement, 0.0);
}

TEST(ExcitingMotion, MoreCandidatesNeverGiveLess) {
  const RobotModel model = pa10();
  JointSignals signals;
  const RobotFit fit = poor_fit(model, 3, signals);
  ExcitingMotionOptions options;
  const auto sum_of_stds = [&](int candidates) {
    options.candidates = candidates;
    const ExcitingMotion motion = plan_exciting_motion(signals, model, fit, options);
    double sum = 0.0;
    for (const BaseParameter& entry : motion.base_parameters) sum += std::log(entry.std);
    return sum;
  };
  EXPECT_LT(sum_of_stds(40), sum_of_stds(1));
  EXPECT_EQ(format_motion(plan_exciting_motion(signals, model, fit, options), model),
            format_motion(plan_exciting_motion(signals, model, fit, options), model));
}

}  // namespace
}  // namespace pcavr
