// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/export/export_robot.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "export/identified_two_joints.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

TEST(ExportedRobot, IsReadBackFromUrdfWithItsFrictionAndBodies) {
  const auto robot = two_joint_robot();
  ASSERT_TRUE(robot) << robot.error().to_string();
  const TemporaryFolder folder;
  ASSERT_TRUE(write_robot_urdf(*robot, two_joint_urdf(), folder.path()));
  const auto read = read_urdf(folder.path() / kRobotUrdfFile);
  ASSERT_TRUE(read) << read.error().to_string();
  ASSERT_EQ(read->joints.size(), 2U);
  EXPECT_NEAR(read->joints[0].damping, 1.23456789, 1e-9);
  EXPECT_NEAR(read->joints[0].friction, 0.456789, 1e-9);
  EXPECT_NEAR(read->joints[1].damping, 0.25, 1e-9);
  for (std::size_t j = 0; j < 2; ++j) {
    const RigidInertia& body = read->joints[j].body;
    const RigidInertia& expected = robot->model.joints[j].body;
    EXPECT_NEAR(body.mass, 3.25, 1e-9);
    EXPECT_NEAR((body.centre_of_mass - expected.centre_of_mass).norm(), 0.0, 1e-9);
    EXPECT_NEAR((body.inertia_at_com - expected.inertia_at_com).norm(), 0.0, 1e-9);
  }
  const std::string text = *read_file(folder.path() / kRobotUrdfFile);
  EXPECT_NE(text.find("<!-- a comment -->"), std::string::npos);
  EXPECT_EQ(text.find("damping=\"7\""), std::string::npos);
}

TEST(ExportedRobot, FixesJointsThatWereNotIdentifiedAndStatesIt) {
  const auto robot = two_joint_robot();
  ASSERT_TRUE(robot);
  EXPECT_EQ(robot->locked, std::vector<std::string>{"grip"});
  EXPECT_NE(robot->warnings.front().find("grip"), std::string::npos);
}

TEST(ExportedRobot, StatesTheTorqueThatEnginesDoNotHave) {
  const auto robot = two_joint_robot();
  ASSERT_TRUE(robot);
  const ExportResidual& first = robot->residuals.front();
  EXPECT_EQ(first.object, "j1");
  EXPECT_DOUBLE_EQ(first.wanted, 0.3);
  EXPECT_DOUBLE_EQ(first.written, 0.0);
  EXPECT_NE(first.remark.find("stribeck"), std::string::npos) << first.remark;
}

TEST(ExportedRobot, WritesNegativeFrictionAsZeroWithAWarning) {
  const auto robot = two_joint_robot(two_joint_report(-0.2));
  ASSERT_TRUE(robot);
  EXPECT_EQ(robot->joints[1].friction, 0.0);
  EXPECT_TRUE(std::any_of(robot->warnings.begin(), robot->warnings.end(), [](const auto& warning) {
    return warning.find("negative coulomb") != std::string::npos;
  }));
  EXPECT_TRUE(std::any_of(robot->residuals.begin(), robot->residuals.end(),
                          [](const ExportResidual& residual) {
                            return residual.what == "coulomb friction" && residual.wanted == -0.2;
                          }));
}

TEST(ExportedRobot, RefusesAJointWithoutIdentifiedFriction) {
  std::string report = two_joint_report();
  for (const char* term : {"viscous", "coulomb"}) {
    const std::string key = std::string("joint.j2.equivalent.") + term;
    report.replace(report.find(key), key.size(), std::string("joint.j2.other.") + term);
  }
  const auto refused = two_joint_robot(report);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("j2"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
