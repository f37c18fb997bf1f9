// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

struct UrdfOptions {
  /// Folders that hold ROS packages (or are one), searched in this order for package://NAME/...;
  /// then those in the environment's ROS_PACKAGE_PATH; then the folders above the description that
  /// are called NAME, or hold a package NAME. Meshes named by path or file:// are read from all
  /// these folders, and from the description's package (package.xml, or the folder above urdf/ or
  /// robots/) or folder. Others are left out with a warning.
  std::vector<std::filesystem::path> package_folders = {};
  /// Whether a moving body without a mass, or with an inertia that no body can have, is an Error.
  /// Otherwise it is a warning: enough for kinematics.
  bool requires_inertia = false;
  /// Whether inertias are not checked: others will take their place.
  bool ignores_inertia = false;
  /// Whether a mesh that is not found is an Error. Otherwise it is a warning.
  bool requires_meshes = false;
};

/// Reads a robot description in URDF [wiki.ros.org/urdf/XML], by urdfdom. Movable joints: revolute,
/// continuous, prismatic; fixed ones are merged; floating and planar ones are Errors. Errors name
/// file, line, link or joint and what to do: not XML, no robot, duplicate names, no or several root
/// links, a link with two parents, a loop, an unknown link, an axis of zero, limits reversed, a
/// mimic joint without its leader, negative mass, numbers that are not finite or beyond any
/// robot's. Shapes without extent are left out with a warning. Thread-safe.
[[nodiscard]] Expected<RobotModel> read_urdf(const std::filesystem::path& file,
                                             const UrdfOptions& options = {});

/// The same from text; `file` names it in errors, and relative paths start in its folder.
[[nodiscard]] Expected<RobotModel> parse_urdf(const std::string& text,
                                              const std::filesystem::path& file,
                                              const UrdfOptions& options = {});

}  // namespace pcavr
