// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/transmissions.hpp"

#include <string>

#include <gtest/gtest.h>

#include "pcavr/robots/robot/urdf.hpp"

namespace pcavr {
namespace {

/// One joint, driven by an actuator with this content.
std::string arm_with(const std::string& actuator) {
  return "<robot name='r'><link name='base'/><link name='upper'/>"
         "<joint name='shoulder' type='revolute'><parent link='base'/><child link='upper'/>"
         "<axis xyz='0 1 0'/><limit lower='-1' upper='2' velocity='3' effort='40'/></joint>"
         "<transmission name='t'><joint name='shoulder'/><actuator name='m'>" +
         actuator + "</actuator></transmission></robot>";
}

double armature_of(const std::string& actuator) {
  const auto model = parse_urdf(arm_with(actuator), "the.urdf");
  EXPECT_TRUE(model) << model.error().to_string();
  return model ? model->joints[0].armature : -1.0;
}

TEST(Transmissions, GiveTheRotorsInertiaAsTheJointSeesIt) {
  EXPECT_NEAR(armature_of("<mechanicalReduction> 100 </mechanicalReduction>"
                          "<rotorInertia>4e-5</rotorInertia>"),
              0.4, 1e-12);
  EXPECT_NEAR(armature_of("<drake:gear_ratio value='-100'/><drake:rotor_inertia value='4e-5'/>"),
              0.4, 1e-12);
  EXPECT_EQ(armature_of("<mechanicalReduction>100</mechanicalReduction>"), 0.0);
}

TEST(Transmissions, NameTheJointAndTheGear) {
  const auto found = parse_transmissions(arm_with("<gearStiffness>5e4</gearStiffness>"), "r.urdf");
  ASSERT_TRUE(found && found->size() == 1U);
  EXPECT_EQ(found->front().joint, "shoulder");
  EXPECT_EQ(found->front().gear_stiffness, 5e4);
  EXPECT_FALSE(found->front().reflected_inertia().has_value());
}

TEST(Transmissions, FaultsAreNamed) {
  for (const char* bad : {"<gearStiffness>soft</gearStiffness>", "<rotorInertia>-1</rotorInertia>",
                          "<mechanicalReduction>0</mechanicalReduction>", "<gearStiffness/>"}) {
    const auto model = parse_urdf(arm_with(bad), "the.urdf");
    ASSERT_FALSE(model) << bad;
    EXPECT_NE(model.error().to_string().find("transmission of joint 'shoulder'"), std::string::npos)
        << model.error().to_string();
  }
}

}  // namespace
}  // namespace pcavr
