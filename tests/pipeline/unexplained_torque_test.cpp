// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/robot/unexplained_torque.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kStd = 0.02;
constexpr double kSpeed = 0.5;  // [rad/s]

/// One joint at a steady speed, whose fit leaves `relative` of its torque.
RobotIdentification fitted(double relative) {
  RobotIdentification found;
  JointFit joint;
  joint.name = "j1";
  joint.train = {.rms = 2.0 * relative, .relative = relative};
  joint.friction = {{FrictionTerm::coulomb, 0.1, kStd, true},
                    {FrictionTerm::viscous, 0.8, kStd, true}};
  joint.equivalent = joint.friction;
  found.fit.joints.push_back(joint);
  found.signals.velocity = Eigen::MatrixXd::Constant(50, 1, kSpeed);
  return found;
}

TEST(UnexplainedTorque, IsInTheStdsOfFriction) {
  RobotIdentification found = fitted(0.5);
  doubt_unexplained_torque(found);
  const JointFit& joint = found.fit.joints.front();
  for (const auto* terms : {&joint.friction, &joint.equivalent}) {
    EXPECT_NEAR((*terms)[0].std, std::hypot(kStd, 1.0), 1e-12);
    EXPECT_NEAR((*terms)[1].std, std::hypot(kStd, 1.0 / kSpeed), 1e-12);
  }
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes.front().find("joint j1: 50 % of its torque"), std::string::npos);
}

TEST(UnexplainedTorque, OfUsualSizeChangesNothing) {
  RobotIdentification found = fitted(0.15);
  doubt_unexplained_torque(found);
  EXPECT_EQ(found.fit.joints.front().friction.front().std, kStd);
  EXPECT_TRUE(found.notes.empty());
}

}  // namespace
}  // namespace pcavr
