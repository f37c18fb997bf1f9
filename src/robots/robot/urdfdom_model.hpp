// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <urdf_model/model.h>
#include <urdf_world/types.h>

namespace pcavr::robot {

/// The model that urdfdom made of a text, and the errors that it logged.
struct UrdfdomResult {
  urdf::ModelInterfaceSharedPtr model;  ///< null on errors
  std::vector<std::string> errors;
};

/// Parses by urdfdom, which logs to a global: its messages are caught here, and calls by several
/// threads wait for each other.
[[nodiscard]] UrdfdomResult parse_by_urdfdom(const std::string& text);

}  // namespace pcavr::robot
