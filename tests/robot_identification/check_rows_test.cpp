// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/core/random.hpp"
#include "pcavr/robot_identification/log_checks.hpp"

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
