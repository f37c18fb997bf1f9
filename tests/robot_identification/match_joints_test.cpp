// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "pcavr/robots/robot_identification/log_checks.hpp"

#include "robot_identification/simulated_arm.hpp"

namespace pcavr {
namespace {

JointLog log_of(const std::vector<std::string>& joints) {
  JointLog log;
  log.joints = joints;
  return log;
}

TEST(MatchJoints, BringsNamesIntoTheOrderOfTheChain) {
  const RobotModel model = pa10();
  std::vector<std::string> names;
  for (const RobotJoint& joint : model.joints) names.push_back(joint.name);
  std::swap(names[0], names[3]);
  const auto matched = match_joints(log_of(names), model);
  ASSERT_TRUE(matched);
  EXPECT_EQ(matched->columns[0], 3U);
  EXPECT_EQ(matched->columns[3], 0U);
}

TEST(MatchJoints, CountsNumbersFromZeroOrOne) {
  const RobotModel model = pa10();
  for (const int first : {0, 1}) {
    std::vector<std::string> names;
    for (int j = 0; j < 7; ++j) names.push_back(std::to_string(first + j));
    const auto matched = match_joints(log_of(names), model);
    ASSERT_TRUE(matched) << matched.error().to_string();
    EXPECT_EQ(matched->columns, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6}));
  }
}

TEST(MatchJoints, LocksJointsThatTheLogDoesNotHave) {
  const auto matched = match_joints(log_of({"1", "2", "3", "4", "5"}), pa10());
  ASSERT_TRUE(matched);
  EXPECT_EQ(matched->model.dof, 5U);
  ASSERT_EQ(matched->notes.size(), 1U);
}

TEST(MatchJoints, IgnoresCaseAndSeparatorsWhereThatIsUnambiguous) {
  RobotModel model = pa10();
  std::vector<std::string> names;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    model.joints[j].name = "joint_" + std::to_string(j + 1);
    names.push_back("Joint" + std::to_string(j + 1));
  }
  std::swap(names[0], names[3]);
  const auto matched = match_joints(log_of(names), model);
  ASSERT_TRUE(matched) << matched.error().to_string();
  EXPECT_EQ(matched->columns, (std::vector<std::size_t>{3, 1, 2, 0, 4, 5, 6}));
  model.joints[1].name = "joint-1";
  EXPECT_FALSE(match_joints(log_of(names), model)) << "joint_1 or joint-1";
}

TEST(MatchJoints, NamesAnUnknownJoint) {
  const auto matched = match_joints(log_of({"elbow_of_another_arm"}), pa10());
  ASSERT_FALSE(matched);
  EXPECT_EQ(matched.error().place, "q_elbow_of_another_arm");
}

}  // namespace
}  // namespace pcavr
