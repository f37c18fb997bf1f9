// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/arm/driven_arm.hpp"
#include "pcavr/robots/arm/identified_arm.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {
namespace {

constexpr char kTwoJoints[] = R"(<robot name="two">
<link name="base"/>
<link name="a"><inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<link name="b"><inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="1" effort="10"/></joint>
<joint name="j2" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
<origin xyz="0 0 0.3"/><limit lower="-2" upper="2" velocity="1" effort="10"/></joint>
</robot>)";

}  // namespace

void identified_arm(std::string_view bytes) {
  static const RobotModel described = parse_urdf(kTwoJoints, "two.urdf").value();
  const Expected<IdentifiedArm> arm = parse_identified_arm(std::string(bytes), "report", described);
  if (!arm) {
    const Error& error = arm.error();
    PCAVR_REQUIRE(error.file == "report" && !error.message.empty() && !error.hint.empty(),
                  error.to_string());
    return;
  }
  // An accepted arm can be simulated.
  DrivenArm driven(arm->model, arm->joints);
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm->model.dof));
  driven.reset(q);
  driven.step(q, q, 0.001);
}

}  // namespace pcavr::fuzz
