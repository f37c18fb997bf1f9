// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "fuzz/targets.hpp"

namespace pcavr::fuzz {

void urdf(std::string_view bytes) {
  // A folder that does not exist: meshes are looked for, and not found.
  const std::string file = "/no-such-folder/the-file";
  const Expected<RobotModel> model = parse_urdf(std::string(bytes), file);
  if (!model) {
    const Error& error = model.error();
    PCAVR_REQUIRE(error.file == file && !error.message.empty() && !error.hint.empty(),
                  error.to_string());
    return;
  }
  for (const Error& warning : model->warnings) {
    PCAVR_REQUIRE(!warning.message.empty() && !warning.hint.empty(), warning.to_string());
  }
  // Kinematics work for every model that is accepted.
  PCAVR_REQUIRE(!model->links.empty() && model->coordinate_joints().size() == model->dof);
  RobotDynamics dynamics(*model);
  dynamics.forward_kinematics(
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(model->dof), 0.3));
  for (const RobotJoint& joint : model->joints) {
    PCAVR_REQUIRE(joint.coordinate < model->dof && joint.axis.allFinite());
    PCAVR_REQUIRE(!joint.parent || *joint.parent < model->joints.size());
  }
}

}  // namespace pcavr::fuzz
