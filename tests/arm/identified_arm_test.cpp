// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/arm/identified_arm.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "fuzz/targets.hpp"
#include "support/source_folder.hpp"

namespace pcavr {
namespace {

std::string two_joints() {
  return read_file(source_folder() / "tests/fuzz/corpus/identified_arm/two_joints.json").value();
}

/// Joints j1 and j2.
RobotModel two_joint_arm() {
  const std::string inertial =
      "<inertial><mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
      "izz=\"1\"/></inertial>";
  const std::string limit = "<limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"10\"/>";
  return parse_urdf("<robot name=\"two\"><link name=\"base\"/><link name=\"a\">" + inertial +
                        "</link><link name=\"b\">" + inertial +
                        "</link><joint name=\"j1\" type=\"revolute\"><parent link=\"base\"/>"
                        "<child link=\"a\"/><axis xyz=\"0 0 1\"/>" +
                        limit +
                        "</joint><joint name=\"j2\" type=\"revolute\"><parent link=\"a\"/>"
                        "<child link=\"b\"/><axis xyz=\"0 1 0\"/>" +
                        limit + "</joint></robot>",
                    "two.urdf")
      .value();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(IdentifiedArm, HasTheReportsInertiasAndFriction) {
  const auto arm = parse_identified_arm(two_joints(), "report.json", two_joint_arm());
  ASSERT_TRUE(arm) << arm.error().to_string();
  ASSERT_EQ(arm->joints.size(), 2U);
  EXPECT_DOUBLE_EQ(arm->model.joints[0].body.mass, 1.0);
  EXPECT_DOUBLE_EQ(arm->joints[1].value_of(FrictionTerm::viscous), 1.0);
  EXPECT_DOUBLE_EQ(arm->joints[1].value_of(FrictionTerm::coulomb), 0.5);
}

TEST(IdentifiedArm, NamesWhatIsWrongWithAReport) {
  const auto refused = [](const std::string& text, const std::string& why) {
    const auto arm = parse_identified_arm(text, "report.json", two_joint_arm());
    ASSERT_FALSE(arm) << why;
    EXPECT_NE(arm.error().message.find(why), std::string::npos) << arm.error().to_string();
    EXPECT_EQ(arm.error().file, "report.json");
  };
  const std::string good = two_joints();
  refused("not json", "no identification report");
  refused(replaced(good, "identification/1", "identification/9"), "no identification report");
  refused(replaced(good, "true", "false"), "not possible");
  refused(replaced(good, "joint.j1.smoothing_speed", "joint.j1.other"), "friction of joint j1");
  refused(replaced(good, "[1.0,", "[-1.0,"), "mass");
  refused(replaced(good, "[1.0, 0.0, 0.0,", "[1.0, 0.0,"), "ten inertial parameters");
  refused(replaced(good, "joint.j2.inertial", "joint.j3.inertial"), "j3");
}

TEST(IdentifiedArm, TheFuzzTargetAcceptsItsCorpus) {
  EXPECT_NO_THROW(fuzz::identified_arm(two_joints()));
  for (std::size_t i = 0; i < two_joints().size(); i += 7) {
    EXPECT_NO_THROW(fuzz::identified_arm(two_joints().substr(0, i))) << i;
  }
}

}  // namespace
}  // namespace pcavr
