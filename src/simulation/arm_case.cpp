// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/arm_case.hpp"

#include <array>
#include <string_view>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "simulation/arm_description.hpp"

namespace pcavr::simulation {
namespace {

constexpr std::uint64_t kArmStream = 90;
constexpr double kStylusLength = 0.13;  ///< from the flange to the tip's centre [m]

/// Place on the table, behind the row of bodies and between them: both are within reach.
const Eigen::Vector3d kRobotBase(0.32, -0.04, 0.0);

/// Values that are typical of arms of this size with strain wave gears; ours, by axis.
struct AxisRange {
  double rotor;           ///< inertia seen from the joint [kg m^2]
  double friction;        ///< Coulomb [N m]
  double viscous;         ///< [N m s/rad]
  double gear_stiffness;  ///< [N m/rad]
};
constexpr std::array<AxisRange, 6> kAxes = {{{0.40, 3.0, 6.0, 5.0e4},
                                             {0.40, 3.0, 6.0, 5.0e4},
                                             {0.25, 2.0, 4.0, 3.0e4},
                                             {0.06, 0.6, 0.8, 1.0e4},
                                             {0.06, 0.6, 0.8, 8.0e3},
                                             {0.03, 0.3, 0.4, 4.0e3}}};

PlantJoint make_joint(const AxisRange& axis, Random& random) {
  PlantJoint joint;
  joint.coulomb_friction = axis.friction * random.uniform(0.7, 1.3);
  joint.static_friction = joint.coulomb_friction * random.uniform(1.1, 1.4);
  joint.viscous_friction = axis.viscous * random.uniform(0.7, 1.3);
  joint.stribeck_speed = random.uniform(0.01, 0.04);
  joint.breakaway_deflection = random.uniform(0.5e-3, 2e-3);
  joint.gear_stiffness = axis.gear_stiffness * random.uniform(0.8, 1.2);
  return joint;
}

/// Data sheet of the gears: the actual ones differ by up to 20 %.
std::string transmissions() {
  std::string text;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    text += fmt::format(
        R"(  <transmission name="drive{0}">
    <joint name="joint{0}"/>
    <actuator name="motor{0}">
      <gearStiffness>{1:g}</gearStiffness>
    </actuator>
  </transmission>
)",
        i + 1, kAxes[i].gear_stiffness);
  }
  return text;
}

/// The description's body, as it might have been built.
void vary(RigidInertia& body, Random& random) {
  const double factor = random.uniform(0.95, 1.05);
  body.mass *= factor;
  body.inertia_at_com *= factor;
  for (int k = 0; k < 3; ++k) body.centre_of_mass[k] += random.uniform(-0.005, 0.005);
}

}  // namespace

std::string arm_description(double tip_radius) {
  std::string text(six_axis_arm());
  const std::size_t end = text.rfind("</robot>");
  PCAVR_REQUIRE(end != std::string::npos && tip_radius > 0.0, end, tip_radius);
  // A steel rod with a ball.
  const double shaft = 0.55 * tip_radius;
  const std::string stylus = fmt::format(
      R"(  <link name="stylus">
    <inertial>
      <origin xyz="0 0 {0:.6f}"/>
      <mass value="0.12"/>
      <inertia ixx="0.000170" ixy="0" ixz="0" iyy="0.000170" iyz="0" izz="0.000004"/>
    </inertial>
    <visual><origin xyz="0 0 {0:.6f}" rpy="0 0 0"/><geometry><cylinder radius="{1:.6f}" length="{2:.6f}"/></geometry><material name="dark"/></visual>
    <collision><origin xyz="0 0 {0:.6f}" rpy="0 0 0"/><geometry><cylinder radius="{1:.6f}" length="{2:.6f}"/></geometry></collision>
  </link>
  <link name="{3}">
    <visual><geometry><sphere radius="{4:.6f}"/></geometry><material name="dark"/></visual>
    <collision><geometry><sphere radius="{4:.6f}"/></geometry></collision>
  </link>
  <joint name="stylus_mount" type="fixed">
    <parent link="tool"/>
    <child link="stylus"/>
  </joint>
  <joint name="tip_mount" type="fixed">
    <parent link="stylus"/>
    <child link="{3}"/>
    <origin xyz="0 0 {2:.6f}"/>
  </joint>
)",
      0.5 * kStylusLength, shaft, kStylusLength, kArmTip, tip_radius);
  text.insert(end, stylus + transmissions());
  return text;
}

PlantArm make_arm(std::uint64_t seed, double tip_radius, const Eigen::Vector3d& p_base_start) {
  Random random = Random(seed).fork(kArmStream);
  const Expected<RobotModel> described = parse_urdf(arm_description(tip_radius), "robot.urdf");
  PCAVR_REQUIRE(described.has_value());
  PlantArm arm{.described = *described,
               .actual = *described,
               .tip = described->link_index(kArmTip).value(),
               .T_base_robot = Pose::from_translation(kRobotBase),
               .q_start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(described->dof)),
               .joints = {},
               .bandwidth = random.uniform(12.0, 20.0),
               .compensated_friction = random.uniform(0.6, 0.95)};
  PCAVR_REQUIRE(arm.described.joints.size() == kAxes.size(), arm.described.joints.size());
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    arm.joints.push_back(make_joint(kAxes[i], random));
    vary(arm.actual.joints[i].body, random);
    arm.actual.joints[i].armature = kAxes[i].rotor * random.uniform(0.8, 1.2);
    arm.described.joints[i].armature = kAxes[i].rotor;
  }
  // Elbow up, the stylus down.
  arm.q_start << 0.0, 0.3, 0.3, 0.0, 0.9, 0.0;
  InverseKinematics inverse(arm.described, arm.tip);
  const Pose T_robot_tip(Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0),
                         arm.T_base_robot.inverse() * p_base_start);
  const IkResult found = inverse.solve(T_robot_tip, arm.q_start);
  PCAVR_REQUIRE(found.status == IkStatus::kReached, p_base_start.x(), p_base_start.y(),
                p_base_start.z());
  return arm;
}

}  // namespace pcavr::simulation
