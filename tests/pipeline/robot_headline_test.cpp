// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "pipeline/robot/identify_robot_headline.hpp"

namespace pcavr {
namespace {

RobotIdentification three_joints() {
  RobotIdentification found;
  for (const double error : {0.04, 0.11, 0.02}) {
    JointFit& joint = found.fit.joints.emplace_back();
    joint.name = "joint_" + std::to_string(found.fit.joints.size());
    joint.held_out.relative = error;
  }
  found.fit.is_physical = true;
  found.fit.base_parameters.resize(3);
  found.fit.base_parameters[1].is_excited = true;
  return found;
}

TEST(RobotHeadline, NamesTheMedianAndTheWorstJoint) {
  const RobotIdentification found = three_joints();
  EXPECT_EQ(robot_verdict(found),
            "The fitted torques are 4.00 % off on the held-out part at the median joint, 11.0 % at "
            "the worst, joint_2. The bodies found are physically possible.");
  const ReportTable table = robot_headline(found);
  ASSERT_EQ(table.rows.size(), 3U);  // nothing was replayed, no contact observed
  EXPECT_EQ(table.rows[0][1], "4.00");
  EXPECT_EQ(table.rows[1][0], "Torque error, held out, worst joint, joint_2");
  EXPECT_EQ(table.rows[2][1], "1 of 3");
}

TEST(RobotHeadline, HasThePositionOfAReplay) {
  RobotIdentification found = three_joints();
  found.replay.simulated.is_finite = true;
  found.replay.after_1s = Eigen::Vector3d(0.01, 0.02, 0.005);
  EXPECT_EQ(robot_headline(found).rows[2][1], "1.15");  // deg
}

}  // namespace
}  // namespace pcavr
