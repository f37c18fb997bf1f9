// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "robot_identification/simulated_arm.hpp"

namespace pcavr {
namespace {

constexpr double kMaxGap = 0.05;

JointLog short_log() { return simulated_log(pa10(), {.duration = 12.0}); }

TEST(CheckRows, FindsNothingInASoundLog) {
  JointLog log = short_log();
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  EXPECT_TRUE(rows.errors.empty()) << rows.errors.front().to_string();
  EXPECT_TRUE(rows.warnings.empty()) << rows.warnings.front().to_string();
}

TEST(CheckRows, NamesTheRowWhoseStampIsOfAnotherTime) {
  JointLog log = short_log();
  for (std::size_t i = 700; i < log.t.size(); ++i) log.t[i] += 6e7;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_EQ(rows.errors.back().line, log.lines[700]);
  EXPECT_EQ(rows.errors.back().message, "the time jumps by 6e+07 s");
}

TEST(CheckRows, LeavesTheSurroundingsOfAPauseOut) {
  JointLog log = short_log();
  for (std::size_t i = 700; i < log.t.size(); ++i) log.t[i] += 60.0;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  EXPECT_TRUE(rows.errors.empty()) << rows.errors.front().to_string();
  ASSERT_FALSE(rows.warnings.empty());
  EXPECT_NE(rows.warnings.back().message.find("the longest 60 s"), std::string::npos);
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

/// A log with the velocities of the positions.
JointLog log_with_velocities() {
  JointLog log = short_log();
  log.velocity = log.position;
  for (Eigen::Index j = 0; j < log.position.cols(); ++j) {
    log.velocity.col(j) = differentiate(log.position.col(j), log.t[1] - log.t[0]);
  }
  return log;
}

TEST(CheckRows, FindsVelocitiesInDegrees) {
  JointLog log = log_with_velocities();
  JointLog sound = log;
  EXPECT_TRUE(check_rows(sound, pa10(), kMaxGap).errors.empty());
  log.velocity *= 180.0 / std::numbers::pi;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_NE(rows.errors[0].message.find("velocities"), std::string::npos);
  EXPECT_NE(rows.errors[0].place.find(log.joints[0]), std::string::npos);
}

LogFindings found_with_stamps(JointLog log, double per_second) {
  for (double& t : log.t) t *= per_second;
  return check_rows(log, pa10(), kMaxGap);
}

TEST(CheckRows, NamesTheUnitOfStampsThatVelocitiesContradict) {
  for (const auto& [per_second, unit] :
       {std::pair{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}) {
    const LogFindings rows = found_with_stamps(log_with_velocities(), per_second);
    ASSERT_EQ(rows.errors.size(), 1U) << unit;
    EXPECT_EQ(rows.errors[0].place, "t");
    EXPECT_NE(rows.errors[0].message.find(unit), std::string::npos) << rows.errors[0].message;
  }
  // Ticks of 10 ms.
  const LogFindings ticks = found_with_stamps(log_with_velocities(), 100.0);
  ASSERT_EQ(ticks.errors.size(), 1U);
  EXPECT_NE(ticks.errors[0].message.find("would be 0.01 s"), std::string::npos)
      << ticks.errors[0].message;
}

TEST(CheckRows, FindsStampsThatAreNoSecondsWithoutVelocities) {
  for (const double per_second : {1e3, 1e6, 200.0}) {  // 200: rows that are counted
    const LogFindings rows = found_with_stamps(short_log(), per_second);
    ASSERT_EQ(rows.errors.size(), 1U) << per_second;
    EXPECT_NE(rows.errors[0].message.find("the stamps are milliseconds, ticks"), std::string::npos)
        << rows.errors[0].message;
  }
  const LogFindings fast = found_with_stamps(short_log(), 1e-3);
  ASSERT_FALSE(fast.errors.empty());
  EXPECT_NE(fast.errors[0].message.find("beyond any arm's joint"), std::string::npos)
      << fast.errors[0].message;
}

TEST(CheckRows, FindsTheOneJointWhoseVelocitiesAreInAnotherUnit) {
  JointLog log = log_with_velocities();
  log.velocity.col(3) *= 100.0;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_EQ(rows.errors.size(), 1U);
  EXPECT_NE(rows.errors[0].place.find(log.joints[3]), std::string::npos);
}

/// Joint 1 rests and its encoder flickers; all positions are rounded as they are logged.
JointLog log_with_flicker() {
  constexpr double kQuantum = 1e-4;  // [rad]
  JointLog log = log_with_velocities();
  Random random(7);
  for (Eigen::Index i = 0; i < log.position.rows(); ++i) {
    const double draw = random.uniform(0.0, 1.0);
    const double flicker = draw < 0.01 ? -kQuantum : draw < 0.02 ? kQuantum : 0.0;
    log.position(i, 1) = 0.5 + flicker;
    log.velocity(i, 1) = 1e-3;  // the sensor's offset
  }
  log.position = kQuantum * (log.position / kQuantum).array().round();
  return log;
}

TEST(CheckRows, DoesNotTakeAFlickeringEncoderAtRestForAStuckOne) {
  JointLog log = log_with_flicker();
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  EXPECT_TRUE(rows.errors.empty()) << rows.errors.front().to_string();
}

TEST(CheckRows, FindsAStuckJointInRoundedPositions) {
  JointLog log = log_with_flicker();
  for (Eigen::Index i = 800; i < 860; ++i) log.position(i, 2) = log.position(800, 2);
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_NE(rows.errors[0].place.find(log.joints[2]), std::string::npos);
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

TEST(CheckRows, ASpoiledRowIsNoDegrees) {
  JointLog log = short_log();
  log.position(700, 2) = 47.0;
  const LogFindings rows = check_rows(log, pa10(), kMaxGap);
  ASSERT_FALSE(rows.errors.empty());
  EXPECT_EQ(rows.errors[0].message.find("degrees"), std::string::npos) << rows.errors[0].message;
  EXPECT_EQ(rows.errors[0].line, log.lines[700]);
}

}  // namespace
}  // namespace pcavr
