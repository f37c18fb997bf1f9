// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>

#include "pcavr/teleoperation/ros2/ros2_setup.hpp"

namespace pcavr {

// Two links in a plane, on a pedestal of 1 m, and a gripper.
inline constexpr char kPlanarArm[] = R"(<robot name="planar">
  <link name="world"/><link name="base_link"/><link name="upper"/><link name="fore"/>
  <link name="tip"/><link name="finger"/>
  <joint name="pedestal" type="fixed"><parent link="world"/><child link="base_link"/>
    <origin xyz="0 0 1"/></joint>
  <joint name="shoulder" type="revolute"><parent link="base_link"/><child link="upper"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
  <joint name="flange" type="fixed"><parent link="fore"/><child link="tip"/>
    <origin xyz="0.3 0 0"/></joint>
  <joint name="grip" type="prismatic"><parent link="tip"/><child link="finger"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.05" velocity="1" effort="1"/></joint>
</robot>)";

/// The joint states of that arm on `/joint_states`, with its description in `folder`.
inline Ros2Setup planar_arm_setup(const std::filesystem::path& folder) {
  Ros2Setup setup;
  setup.tool_urdf = folder / "arm.urdf";
  std::ofstream(setup.tool_urdf) << kPlanarArm;
  setup.tool = {"/joint_states", "sensor_msgs/msg/JointState", {}};
  setup.tool_link = "tip";
  return setup;
}

}  // namespace pcavr
