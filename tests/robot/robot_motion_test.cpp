// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/robots/robot/urdf.hpp"

#include "robot/random_robot.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

struct Drift {
  double relative = 0.0;  ///< largest change of the energy, over the largest kinetic energy
  double max_speed = 0.0;
};

/// An arm without friction that swings for 10 s at 1 kHz.
Drift swing(const RobotModel& model, const Eigen::VectorXd& start) {
  RobotMotion motion(model);
  Eigen::VectorXd q = start;
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(q.size());
  const Eigen::VectorXd tau = Eigen::VectorXd::Zero(q.size());
  const double energy = motion.dynamics().potential_energy(q);
  double max_kinetic = 0.0;
  double max_change = 0.0;
  Drift drift;
  for (int i = 0; i < 10'000; ++i) {
    motion.step(tau, 0.001, q, dq);
    const double kinetic = motion.dynamics().kinetic_energy(q, dq);
    max_kinetic = std::max(max_kinetic, kinetic);
    max_change =
        std::max(max_change, std::abs(kinetic + motion.dynamics().potential_energy(q) - energy));
    drift.max_speed = std::max(drift.max_speed, dq.lpNorm<Eigen::Infinity>());
  }
  drift.relative = max_change / max_kinetic;
  return drift;
}

TEST(RobotMotion, AFreelySwingingArmKeepsItsEnergy) {
  for (const char* name : {"pa10", "irb120_like"}) {
    const RobotModel model =
        read_urdf(source_folder() / "calib/robots" / name / (std::string(name) + ".urdf")).value();
    Eigen::VectorXd q = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model.dof), 0.3);
    q[1] = 1.2;
    const Drift drift = swing(model, q);
    RecordProperty(std::string(name) + "_drift", std::to_string(drift.relative * 1e6) + "e-6");
    EXPECT_LT(drift.relative, 1e-4) << name;
    EXPECT_GT(drift.max_speed, 3.0) << name;  // it does swing
  }
}

TEST(RobotMotion, APendulumHasItsPeriod) {
  // A point mass of 2 kg on 0.5 m, about y.
  RobotModel model;
  model.links.push_back({"base", std::nullopt, {}, std::nullopt, {}, {}});
  RobotJoint joint;
  joint.name = "hinge";
  joint.axis = Eigen::Vector3d::UnitY();
  joint.body = {2.0, {0.0, 0.0, -0.5}, Eigen::Matrix3d::Zero()};
  model.joints.push_back(joint);
  model.dof = 1;
  RobotMotion motion(model);
  Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 1e-3);
  Eigen::VectorXd dq = Eigen::VectorXd::Zero(1);
  const double period = 2.0 * std::numbers::pi * std::sqrt(0.5 / kStandardGravity);
  for (int i = 0; i < 1000; ++i) motion.step(Eigen::VectorXd::Zero(1), period / 1000.0, q, dq);
  // The amplitude prolongs it by 1e-6 / 16.
  EXPECT_NEAR(q[0], 1e-3, 1e-9);
  EXPECT_NEAR(dq[0], 0.0, 1e-8);
}

TEST(RobotMotion, HalvingTheStepDividesTheErrorBySixteen) {
  Random random(6);
  const RobotModel model = test::random_robot(random, {.joints = 4});
  const auto end = [&](int steps) {
    RobotMotion motion(model);
    Eigen::VectorXd q = Eigen::VectorXd::Constant(4, 0.5);
    Eigen::VectorXd dq = Eigen::VectorXd::Constant(4, 1.0);
    const Eigen::VectorXd tau = Eigen::VectorXd::Constant(4, 0.2);
    for (int i = 0; i < steps; ++i) motion.step(tau, 0.2 / steps, q, dq);
    return q;
  };
  const Eigen::VectorXd exact = end(3200);
  const double ratio = (end(50) - exact).norm() / (end(100) - exact).norm();
  EXPECT_NEAR(ratio, 16.0, 3.0);
}

}  // namespace
}  // namespace pcavr
