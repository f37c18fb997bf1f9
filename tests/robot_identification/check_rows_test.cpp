// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/core/random.hpp"
#include "pcavr/recording/import_joint_log.hpp"
#include "pcavr/robot_identification/log_checks.hpp"
#include "pcavr/robot_identification/robot_fit.hpp"

#include "robot_identification/simulated_arm.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

constexpr double kMaxGap = 0.05;

JointLog short_log() { return simulated_log(pa10(), {.duration = 12.0}); }

LogFindings shown_by(const JointLog& log) {
  JointSignals signals = joint_signals(log, {});
  return check_hypotheses(signals, pa10());
}

TEST(CheckRows, FindsNothingInASoundLog) {
  JointLog log = short_log();
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  EXPECT_TRUE(rows.errors.empty()) << rows.errors.front().to_string();
  EXPECT_TRUE(rows.warnings.empty()) << rows.warnings.front().to_string();
  const LogFindings shown = shown_by(log);
  EXPECT_TRUE(shown.errors.empty()) << shown.errors.front().to_string();
  EXPECT_TRUE(shown.warnings.empty());
}

TEST(CheckRows, UnwrapsFullTurnsAndNamesJointAndRow) {
  JointLog log = short_log();
  const Eigen::MatrixXd before = log.position;
  for (Eigen::Index i = 700; i < 1500; ++i) log.position(i, 4) -= 2.0 * std::numbers::pi;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  EXPECT_TRUE(rows.errors.empty());
  ASSERT_FALSE(rows.warnings.empty());
  EXPECT_EQ(rows.warnings.back().line, 702);
  EXPECT_NE(rows.warnings.back().place.find(log.joints[4]), std::string::npos);
  EXPECT_LT((log.position - before).cwiseAbs().maxCoeff(), 1e-9);
}

// Two turns away from the limits, where degrees would be inside them.
TEST(CheckRows, FullTurnsAreNotTakenForDegrees) {
  JointLog log = short_log();
  for (Eigen::Index i = 700; i < log.position.rows(); ++i) {
    log.position(i, 1) += 4.0 * std::numbers::pi;
  }
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  EXPECT_TRUE(rows.errors.empty()) << rows.errors.front().to_string();
  ASSERT_FALSE(rows.warnings.empty());
  EXPECT_NE(rows.warnings.back().message.find("full turns"), std::string::npos);
}

TEST(CheckRows, FindsVelocitiesInDegrees) {
  JointLog log = short_log();
  log.velocity = log.position;
  for (Eigen::Index j = 0; j < log.position.cols(); ++j) {
    log.velocity.col(j) = differentiate(log.position.col(j), log.t[1] - log.t[0]);
  }
  JointLog sound = log;
  EXPECT_TRUE(check_rows(sound, pa10(), kMaxGap).errors.empty());
  log.velocity *= 180.0 / std::numbers::pi;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_NE(rows.errors[0].message.find("velocities"), std::string::npos);
  EXPECT_NE(rows.errors[0].place.find(log.joints[0]), std::string::npos);
}

TEST(CheckRows, FindsAJump) {
  JointLog log = short_log();
  for (Eigen::Index i = 900; i < log.position.rows(); ++i) log.position(i, 2) += 0.4;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_EQ(rows.errors.size(), 1U);
  EXPECT_EQ(rows.errors[0].line, 902);
}

TEST(CheckRows, FindsAStuckJoint) {
  JointLog log = short_log();
  for (Eigen::Index i = 800; i < 860; ++i) log.position(i, 1) = log.position(800, 1);
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_NEAR(rows.errors[0].line, 803, 2);
  EXPECT_NE(rows.errors[0].place.find(log.joints[1]), std::string::npos);
}

/// The log with joint 1 stuck between two rows.
LogFindings found_stuck(Eigen::Index from, Eigen::Index to) {
  JointLog log = short_log();
  for (Eigen::Index i = from; i < to; ++i) log.position(i, 1) = log.position(from, 1);
  return check_rows(log, pa10(), kMaxGap);
}

// Long enough for the joint to come back from the other side, or until the log ends.
TEST(CheckRows, FindsAJointThatIsStuckForLong) {
  const Eigen::Index end = short_log().position.rows();
  for (const Eigen::Index to : {Eigen::Index{1300}, end}) {
    const LogFindings rows = found_stuck(800, to);
    ASSERT_FALSE(rows.errors.empty()) << to;
    EXPECT_NE(rows.errors[0].message.find("does not change"), std::string::npos)
        << rows.errors[0].to_string();
    EXPECT_NEAR(rows.errors[0].line, 803, 2);
  }
}

TEST(CheckRows, FindsSaturatedTorques) {
  JointLog log = short_log();
  const double limit = 0.7 * log.torque.col(1).maxCoeff();
  log.torque.col(1) = log.torque.col(1).cwiseMin(limit);
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_NE(rows.errors[0].message.find("saturates"), std::string::npos);
  EXPECT_NE(rows.errors[0].place.find(log.joints[1]), std::string::npos);
}

// A wrist whose torque is mostly noise reaches its limit in single rows.
TEST(CheckRows, FindsSaturationInSingleRows) {
  JointLog log = short_log();
  Random random(3);
  for (Eigen::Index i = 0; i < log.torque.rows(); ++i) log.torque(i, 6) += 3.0 * random.normal();
  log.torque.col(6) = log.torque.col(6).cwiseMax(0.7 * log.torque.col(6).minCoeff());
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_EQ(rows.errors.size(), 1U);
  EXPECT_NE(rows.errors[0].place.find(log.joints[6]), std::string::npos);
}

TEST(CheckRows, DoesNotTakeRoundedOrRepeatedTorquesForSaturation) {
  JointLog rounded = short_log();
  rounded.torque = (2.0 * rounded.torque).array().round() / 2.0;
  EXPECT_TRUE(check_rows(rounded, pa10(), kMaxGap).errors.empty());
  JointLog repeated = short_log();
  for (Eigen::Index i = 0; i < repeated.torque.rows(); ++i) {
    repeated.torque.row(i) = repeated.torque.row(i - i % 8);
  }
  EXPECT_TRUE(check_rows(repeated, pa10(), kMaxGap).errors.empty());
}

TEST(CheckRows, FindsAGap) {
  JointLog log = short_log();
  for (std::size_t i = 1000; i < log.t.size(); ++i) log.t[i] += 0.3;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_EQ(rows.warnings.size(), 1U);
  EXPECT_EQ(rows.warnings[0].line, 1002);
}

TEST(CheckRows, FindsDegrees) {
  JointLog log = short_log();
  log.position *= 180.0 / std::numbers::pi;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_NE(rows.errors[0].message.find("degrees"), std::string::npos);
}

TEST(CheckHypotheses, FindsSwappedTorques) {
  JointLog log = short_log();
  log.torque.col(3).swap(log.torque.col(5));
  const LogFindings shown = shown_by(log);
  ASSERT_EQ(shown.errors.size(), 1U);
  EXPECT_NE(shown.errors[0].message.find("swapped"), std::string::npos);
  EXPECT_NE(shown.errors[0].message.find(log.joints[3] + " and " + log.joints[5]),
            std::string::npos);
}

TEST(CheckHypotheses, FindsSwappedPositions) {
  JointLog log = short_log();
  log.position.col(1).swap(log.position.col(2));
  const LogFindings shown = shown_by(log);
  ASSERT_EQ(shown.errors.size(), 1U);
  EXPECT_NE(shown.errors[0].message.find("positions of " + log.joints[1] + " and " + log.joints[2]),
            std::string::npos);
}

void swap_joints(JointLog& log, Eigen::Index a, Eigen::Index b) {
  for (Eigen::MatrixXd* columns : {&log.position, &log.torque})
    columns->col(a).swap(columns->col(b));
}

// The last wrists hold so little that their torques are friction's, whichever joint they are of.
TEST(CheckHypotheses, FindsSwappedWristsThatAreAlmostAlike) {
  for (const std::uint64_t seed : {3U, 21U, 22U}) {
    for (const double delay : {0.0, 0.02}) {
      JointLog log = simulated_log(pa10(), {.duration = 20.0, .torque_delay = delay, .seed = seed});
      EXPECT_TRUE(shown_by(log).errors.empty()) << seed << ", " << delay;
      swap_joints(log, 5, 6);
      const LogFindings shown = shown_by(log);
      ASSERT_EQ(shown.errors.size(), 1U) << seed << ", " << delay;
      EXPECT_NE(shown.errors[0].message.find("joint6 and joint7 are swapped"), std::string::npos)
          << shown.errors[0].message;
    }
  }
}

// The rows left out of a short log's fits differ so much that a wrong order may predict them
// better.
TEST(CheckHypotheses, FindsNoSwapInShortLogs) {
  for (const double duration : {1.2, 2.0, 3.0, 5.0}) {
    for (const std::uint64_t seed : {1U, 2U, 54U, 64U}) {
      const LogFindings shown =
          shown_by(simulated_log(pa10(), {.duration = duration, .seed = seed}));
      EXPECT_TRUE(shown.errors.empty()) << duration << " s, seed " << seed;
    }
  }
}

TEST(CheckHypotheses, FindsAGrossSwapInAShortLog) {
  JointLog log = simulated_log(pa10(), {.duration = 2.0});
  log.torque.col(3).swap(log.torque.col(5));
  const LogFindings shown = shown_by(log);
  ASSERT_EQ(shown.errors.size(), 1U);
  EXPECT_NE(shown.errors[0].message.find("joint4 and joint6 are swapped"), std::string::npos)
      << shown.errors[0].message;
}

// Free bodies fit either order within 30 % of each torque: a swap shows against the right order.
TEST(CheckHypotheses, FindsSwappedJointsThatBothFit) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_dynamics");
  JointLog read = import_joint_log(shared_data("real/franka_dynamics"), {}).value().log;
  const MatchedRobot matched =
      match_joints(read, read_urdf(shared_data("real/robots/panda/panda.urdf")).value()).value();
  for (Eigen::MatrixXd* columns : {&read.position, &read.velocity, &read.torque}) {
    columns->col(3).swap(columns->col(4));
  }
  JointSignals signals = joint_signals(read, {});
  const LogFindings shown = check_hypotheses(signals, matched.model);
  ASSERT_EQ(shown.errors.size(), 1U);
  EXPECT_NE(shown.errors[0].message.find("panda_joint4 and panda_joint5 are swapped"),
            std::string::npos)
      << shown.errors[0].to_string();
}

TEST(CheckHypotheses, FindsTheSignOfOneJoint) {
  JointLog log = short_log();
  log.torque.col(3) *= -1.0;
  const LogFindings shown = shown_by(log);
  ASSERT_EQ(shown.errors.size(), 1U);
  EXPECT_NE(shown.errors[0].message.find(log.joints[3]), std::string::npos);
  EXPECT_NE(shown.errors[0].message.find("sign"), std::string::npos);
}

TEST(CheckHypotheses, CorrectsTheSignOfAllTorquesAndReportsIt) {
  JointLog log = short_log();
  log.torque *= -1.0;
  JointSignals signals = joint_signals(log, {});
  const LogFindings shown = check_hypotheses(signals, pa10());
  EXPECT_TRUE(shown.errors.empty());
  ASSERT_EQ(shown.warnings.size(), 1U);
  EXPECT_TRUE(signals.is_sign_changed);
}

TEST(CheckHypotheses, FindsCurrentsInPlaceOfTorques) {
  JointLog log = short_log();
  log.torque *= 0.1;
  const LogFindings shown = shown_by(log);
  ASSERT_FALSE(shown.errors.empty());
  EXPECT_NE(shown.errors[0].message.find("currents"), std::string::npos);
}

TEST(FitRobot, FindsTheJointWhoseTorquesAreLate) {
  JointLog log = simulated_log(pa10(), {.duration = 20.0});
  const RobotFit in_step = fit_robot(joint_signals(log, {}), pa10(), {});
  for (const JointFit& joint : in_step.joints) {
    EXPECT_LT(std::abs(joint.torque_lag.value), std::max(0.012, 3.0 * joint.torque_lag.std))
        << joint.name;
    EXPECT_FALSE(joint.is_out_of_step(0.012)) << joint.name;
  }
  constexpr Eigen::Index kLate = 3;
  const Eigen::VectorXd torque = log.torque.col(kLate);
  const double interval = log.t[1] - log.t[0];
  const auto rows = static_cast<Eigen::Index>(std::lround(0.02 / interval));
  for (Eigen::Index i = 0; i < torque.size(); ++i) {
    log.torque(i, kLate) = torque[std::max<Eigen::Index>(0, i - rows)];
  }
  const RobotFit late = fit_robot(joint_signals(log, {}), pa10(), {});
  EXPECT_NEAR(late.joints[kLate].torque_lag.value + late.torque_lag, 0.02, 0.004);
  EXPECT_GT(late.joints[kLate].torque_lag.value, 5.0 * late.joints[kLate].torque_lag.std);
  EXPECT_TRUE(late.joints[kLate].is_out_of_step(0.012));
  EXPECT_LT(late.joints[kLate].visible_lag(0.012), 0.02);
}

TEST(FitRobot, StatesWhichLagDoesNotShowInASlowMotion) {
  const JointLog log =
      simulated_log(pa10(), {.duration = 12.0, .torque_noise = 3.0, .amplitude_share = 0.1});
  const RobotFit fit = fit_robot(joint_signals(log, {}), pa10(), {});
  for (const JointFit& joint : fit.joints) {
    EXPECT_FALSE(joint.seems_out_of_step(joint.visible_lag(0.012))) << joint.name;
  }
  EXPECT_GT(fit.joints[6].visible_lag(0.012), 0.024);
}

// The Panda's friction after reversals looks like a lag of its joints 5 and 7, 28 and 32 ms.
TEST(FitRobot, DoesNotTakeFrictionForLateTorques) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_dynamics");
  const JointLog log = import_joint_log(shared_data("real/franka_dynamics"), {}).value().log;
  const RobotModel panda = read_urdf(shared_data("real/robots/panda/panda.urdf")).value();
  const RobotModel model = match_joints(log, panda).value().model;
  RobotFitOptions options;
  options.is_extended = options.is_physical = false;
  const RobotFit fit = fit_robot(joint_signals(log, {}), model, options);
  for (const JointFit& joint : fit.joints) EXPECT_FALSE(joint.is_out_of_step(0.012)) << joint.name;
  EXPECT_TRUE(fit.joints[4].seems_out_of_step(0.012));
}

TEST(FitRobot, MeasuresTorquesThatAreLate) {
  const JointLog log = simulated_log(pa10(), {.duration = 20.0, .torque_delay = 0.02});
  const RobotFit fit = fit_robot(joint_signals(log, {}), pa10(), {});
  EXPECT_NEAR(fit.torque_lag, 0.02, 0.003);
}

}  // namespace
}  // namespace pcavr
