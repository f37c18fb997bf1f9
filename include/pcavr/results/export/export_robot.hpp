// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/results/export/exported_world.hpp"
#include "pcavr/robots/arm/identified_arm.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

/// Names of the files of an exported arm.
inline constexpr char kRobotUrdfFile[] = "robot.urdf";
inline constexpr char kRobotMjcfFile[] = "robot.xml";

/// Friction of a joint as engines have it: damping v + friction sign v. Units: of a revolute joint
/// [N m s/rad] and [N m], of a prismatic one [N s/m] and [N].
struct ExportedJoint {
  std::string name;
  double damping = 0.0;
  double friction = 0.0;
};

/// An arm with the identified bodies and joint friction. A value: threads may read it at the same
/// time.
struct ExportedRobot {
  RobotModel model;  ///< the identified joints; others are locked at 0
  std::vector<ExportedJoint> joints;
  std::vector<std::string> locked;  ///< names of the joints that were not identified
  std::vector<ExportedNumber> numbers;
  std::vector<ExportResidual> residuals;
  std::vector<std::string> warnings;
};

/// The friction is the fit's projection on viscous and Coulomb friction (JointFit::equivalent).
/// Errors: a joint without it. Negative values, which no engine has, are written as 0: a warning
/// and a residual.
[[nodiscard]] Expected<ExportedRobot> make_exported_robot(const RobotModel& described,
                                                          const IdentifiedArm& identified);

/// Writes robot.urdf: the description `urdf` (its text) with the identified <inertial> and
/// <dynamics>, all else unchanged. The child link of a joint has the inertia of all that moves with
/// it; links fixed to it have none. Errors, here and below: a file that can't be written.
[[nodiscard]] Expected<void> write_robot_urdf(const ExportedRobot& robot, const std::string& urdf,
                                              const std::filesystem::path& folder);

/// Writes robot.xml for MuJoCo 3: bodies with their child links' names, links as sites, a motor for
/// each joint with a limit of effort, and the collision shapes that are no meshes.
[[nodiscard]] Expected<void> write_robot_mjcf(const ExportedRobot& robot,
                                              const std::filesystem::path& folder);

}  // namespace pcavr
