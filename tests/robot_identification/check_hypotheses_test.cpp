// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/import_joint_log.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

#include "robot_identification/simulated_arm.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

JointLog short_log() { return simulated_log(pa10(), {.duration = 12.0}); }

LogFindings shown_by(const JointLog& log) {
  JointSignals signals = joint_signals(log, {});
  return check_hypotheses(signals, pa10());
}

TEST(CheckHypotheses, FindsNothingInASoundLog) {
  const LogFindings shown = shown_by(simulated_log(pa10(), {.duration = 20.0}));
  EXPECT_TRUE(shown.errors.empty()) << shown.errors.front().to_string();
  EXPECT_TRUE(shown.warnings.empty()) << shown.warnings.front().message;
}

TEST(CheckHypotheses, NotesTheJointsWhoseSwapWouldNotShow) {
  JointLog log = short_log();
  const LogFindings sound = shown_by(log);
  ASSERT_EQ(sound.warnings.size(), 1U);
  EXPECT_NE(sound.warnings[0].message.find("joint6 and joint7"), std::string::npos)
      << sound.warnings[0].message;
  EXPECT_EQ(sound.warnings[0].message.find("joint1"), std::string::npos)
      << sound.warnings[0].message;
  for (Eigen::MatrixXd* columns : {&log.position, &log.torque})
    columns->col(5).swap(columns->col(6));
  const LogFindings swapped = shown_by(log);
  EXPECT_TRUE(swapped.errors.empty());
  ASSERT_EQ(swapped.warnings.size(), 1U);
  EXPECT_NE(swapped.warnings[0].message.find("joint6 and joint7"), std::string::npos)
      << swapped.warnings[0].message;
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

// 11 s of motion: the folds hardly predict each other.
TEST(CheckHypotheses, NamesOrNotesEverySwapOfLbrMed) {
  PCAVR_NEEDS_SHARED_DATA("real/lbr_med");
  const JointLog read =
      import_joint_log(shared_data("real/lbr_med/measurements.csv"), {.period = 0.01}).value().log;
  const MatchedRobot matched =
      match_joints(read, read_urdf(shared_data("real/lbr_med/med7dock.urdf")).value()).value();
  const auto shown_of = [&](Eigen::Index a, Eigen::Index b) {
    JointLog log = reordered(read, matched.columns);
    swap_joints(log, a, b);
    JointSignals signals = joint_signals(log, {});
    return check_hypotheses(signals, matched.model);
  };
  const LogFindings last = shown_of(5, 6);
  ASSERT_EQ(last.errors.size(), 1U);
  EXPECT_NE(last.errors[0].message.find("A6 and A7 are swapped"), std::string::npos)
      << last.errors[0].message;
  // A5 and A7 turn about the same axis where A6 is at 0, which is about where it stays.
  for (const auto& [a, b] : {std::pair{0, 0}, {4, 6}}) {
    const LogFindings shown = shown_of(a, b);
    EXPECT_TRUE(shown.errors.empty()) << shown.errors.front().message;
    ASSERT_EQ(shown.warnings.size(), 2U);  // the first: all signs
    EXPECT_NE(shown.warnings[1].message.find("A5 and A7"), std::string::npos)
        << shown.warnings[1].message;
  }
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
  ASSERT_FALSE(shown.warnings.empty());
  EXPECT_NE(shown.warnings[0].message.find("their sign was changed"), std::string::npos)
      << shown.warnings[0].message;
  EXPECT_TRUE(signals.is_sign_changed);
}

TEST(CheckHypotheses, FindsCurrentsInPlaceOfTorques) {
  JointLog log = short_log();
  log.torque *= 0.1;
  const LogFindings shown = shown_by(log);
  ASSERT_FALSE(shown.errors.empty());
  EXPECT_NE(shown.errors[0].message.find("currents"), std::string::npos);
}

TEST(CheckHypotheses, FindsTorquesInMillinewtonMetres) {
  JointLog log = short_log();
  log.torque *= 1e3;
  const LogFindings all = shown_by(log);
  ASSERT_FALSE(all.errors.empty());
  EXPECT_NE(all.errors[0].message.find("mN m"), std::string::npos) << all.errors[0].message;
  JointLog one = short_log();
  one.torque.col(1) *= 1e3;
  const LogFindings of_one = shown_by(one);
  ASSERT_FALSE(of_one.errors.empty());
  EXPECT_NE(of_one.errors[0].place.find(one.joints[1]), std::string::npos);
  EXPECT_NE(of_one.errors[0].message.find("mN m"), std::string::npos) << of_one.errors[0].message;
}

/// Joint 3 moves, the others rest, held by friction: their torques creep.
JointLog log_of_one_joint(std::uint64_t seed) {
  const SimulatedLogOptions options{.duration = 20.0, .rate = 100.0, .seed = seed};
  Random random(seed);
  JointLog log =
      log_of_motion(pa10(), options, random,
                    [](double t, Eigen::VectorXd& q, Eigen::VectorXd& dq, Eigen::VectorXd& ddq) {
                      q.setConstant(0.3);
                      dq.setZero();
                      ddq.setZero();
                      q[3] += 0.8 * std::sin(1.3 * t);
                      dq[3] = 1.04 * std::cos(1.3 * t);
                      ddq[3] = -1.352 * std::sin(1.3 * t);
                    });
  Eigen::VectorXd creep = Eigen::VectorXd::Zero(7);
  for (Eigen::Index i = 0; i < log.torque.rows(); ++i) {
    for (Eigen::Index j = 0; j < 7; ++j) creep[j] = 0.999 * creep[j] + 0.03 * random.normal();
    creep[3] = 0.0;
    log.torque.row(i) += creep.transpose();
  }
  return log;
}

TEST(CheckHypotheses, AccusesNoJointAtRestAndNamesThem) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    const LogFindings shown = shown_by(log_of_one_joint(seed));
    EXPECT_TRUE(shown.errors.empty()) << seed << ": " << shown.errors.front().to_string();
    ASSERT_FALSE(shown.warnings.empty());
    EXPECT_NE(shown.warnings.back().message.find("rest in most of this motion"), std::string::npos)
        << shown.warnings.back().message;
  }
}

TEST(CheckHypotheses, FindsTheMovingJointsTorqueInARestingOnesColumn) {
  JointLog log = log_of_one_joint(1);
  log.torque.col(3).swap(log.torque.col(5));
  const LogFindings shown = shown_by(log);
  ASSERT_EQ(shown.errors.size(), 1U);
  EXPECT_NE(shown.errors[0].message.find("swapped"), std::string::npos);
}

// One joint at a time: five of six joints rest, and their encoders flicker.
TEST(CheckHypotheses, AcceptsTheUr10esLogsOfSingleJoints) {
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  const RobotModel arm = read_urdf(shared_data("real/ur10e/ur10e.urdf")).value();
  for (int joint = 1; joint <= 6; ++joint) {
    const std::string file =
        "real/ur10e/jointwise_motion/ur-20_01_22-joint_" + std::to_string(joint) + ".csv";
    JointLog read = import_joint_log(shared_data(file), {}).value().log;
    read.torque = 10.0 * read.current;  // about the drives' gains, N m/A
    const MatchedRobot matched = match_joints(read, arm).value();
    JointLog log = reordered(read, matched.columns);
    const LogFindings rows = check_rows(log, matched.model, 0.05);
    EXPECT_TRUE(rows.errors.empty()) << joint << ": " << rows.errors.front().to_string();
    JointSignals signals = joint_signals(log, {});
    const LogFindings shown = check_hypotheses(signals, matched.model);
    EXPECT_TRUE(shown.errors.empty()) << joint << ": " << shown.errors.front().to_string();
  }
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
