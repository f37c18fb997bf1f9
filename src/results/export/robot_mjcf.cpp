// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <variant>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/export_robot.hpp"

#include "results/export/export_text.hpp"

namespace pcavr {
namespace {

using detail::mjcf_pose;
using detail::vector_text;
using detail::xml_text;

std::string robot_inertial(const RigidInertia& body) {
  const Eigen::Matrix3d& i = body.inertia_at_com;
  return fmt::format("<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>",
                     vector_text(body.centre_of_mass), body.mass, i(0, 0), i(1, 1), i(2, 2),
                     i(0, 1), i(0, 2), i(1, 2));
}

std::string mjcf_joint(const RobotJoint& joint, const ExportedJoint& friction) {
  std::string text = fmt::format(
      "<joint name=\"{}\" type=\"{}\" axis=\"{}\" damping=\"{}\" frictionloss=\"{}\" "
      "armature=\"{}\"",
      xml_text(joint.name), joint.kind == JointKind::kPrismatic ? "slide" : "hinge",
      vector_text(joint.axis), friction.damping, friction.friction, joint.armature);
  if (joint.limits.lower && joint.limits.upper) {
    text += fmt::format(" range=\"{} {}\"", *joint.limits.lower, *joint.limits.upper);
  }
  return text + "/>";
}

/// Type and size of a geom; empty for a mesh.
std::string geom_shape(const RobotShape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape.geometry)) {
    return fmt::format("type=\"box\" size=\"{}\"", vector_text(box->size / 2.0));
  }
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape.geometry)) {
    return fmt::format("type=\"cylinder\" size=\"{} {}\"", cylinder->radius,
                       cylinder->length / 2.0);
  }
  if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
    return fmt::format("type=\"sphere\" size=\"{}\"", sphere->radius);
  }
  return "";
}

/// Sites and shapes of the links that move with a joint, or with the base.
std::string links_text(const RobotModel& model, std::optional<std::size_t> joint) {
  std::string text;
  for (const RobotLink& link : model.links) {
    if (link.joint != joint) continue;
    text +=
        fmt::format("<site name=\"{}\" {}/>\n", xml_text(link.name), mjcf_pose(link.T_joint_link));
    for (const RobotShape& shape : link.collisions) {
      const std::string geometry = geom_shape(shape);
      if (geometry.empty()) continue;
      text += fmt::format("<geom {} {}/>\n", geometry,
                          mjcf_pose(link.T_joint_link * shape.T_link_shape));
    }
  }
  return text;
}

std::string joint_body_text(const ExportedRobot& robot, std::size_t index) {
  const RobotJoint& joint = robot.model.joints[index];
  std::string text = fmt::format("<body name=\"{}\" {}>\n{}\n{}\n", xml_text(joint.child_link),
                                 mjcf_pose(joint.T_parent_joint), robot_inertial(joint.body),
                                 mjcf_joint(joint, robot.joints[index])) +
                     links_text(robot.model, index);
  for (std::size_t child = index + 1; child < robot.model.joints.size(); ++child) {
    if (robot.model.joints[child].parent == index) text += joint_body_text(robot, child);
  }
  return text + "</body>\n";
}

std::string motors_text(const RobotModel& model) {
  std::string text;
  for (const RobotJoint& joint : model.joints) {
    if (!joint.limits.effort) continue;
    const double effort = *joint.limits.effort;
    text += fmt::format("<motor name=\"{0}\" joint=\"{0}\" ctrlrange=\"{1} {2}\"/>\n",
                        xml_text(joint.name), -effort, effort);
  }
  return text;
}

}  // namespace

Expected<void> write_robot_mjcf(const ExportedRobot& robot, const std::filesystem::path& folder) {
  // implicitfast takes damping implicitly; shapes meet the bodies of a scene, not each other.
  std::string text = fmt::format(
      "<mujoco model=\"{}\">\n<!-- SI units, frame: the arm's base. -->\n"
      "<compiler angle=\"radian\" autolimits=\"true\"/>\n"
      "<option timestep=\"0.001\" gravity=\"{}\" integrator=\"implicitfast\"/>\n"
      "<default><geom contype=\"1\" conaffinity=\"0\"/></default>\n<worldbody>\n",
      xml_text(robot.model.name), vector_text(robot.model.gravity_base));
  const std::string base = xml_text(robot.model.links.front().name);
  text += fmt::format("<body name=\"{}\">\n", base) + links_text(robot.model, std::nullopt);
  for (std::size_t j = 0; j < robot.model.joints.size(); ++j) {
    if (!robot.model.joints[j].parent) text += joint_body_text(robot, j);
  }
  text +=
      "</body>\n</worldbody>\n<actuator>\n" + motors_text(robot.model) + "</actuator>\n</mujoco>\n";
  return write_file(folder / kRobotMjcfFile, text);
}

}  // namespace pcavr
