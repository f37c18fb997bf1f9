// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"

namespace pcavr {

/// The tool's pose by forward kinematics of a peer's joint positions.
class Ros2ToolJoints {
 public:
  /// Throws ContractError for links that the model does not have; `base` is fixed to the root.
  Ros2ToolJoints(const RobotModel& model, std::size_t base, std::size_t tip);

  /// An Error for positions that are missing, not finite or beyond their limits. Names are in any
  /// order; joints that do not move the tool, as those of a gripper, need not be there.
  [[nodiscard]] Expected<Pose> T_base_tool(const RosJointState& state);
  /// The newest positions [rad or m], by coordinate of the model; 0 for other joints.
  [[nodiscard]] const Eigen::VectorXd& q() const { return q_; }

 private:
  struct Joint {
    std::string name;
    Eigen::Index coordinate = 0;
    double lower = 0.0;  ///< [rad] or [m], with the tolerance of a measured position
    double upper = 0.0;
  };
  std::vector<Joint> joints_;  ///< those that move the tool
  RobotDynamics kinematics_;
  std::size_t tip_;
  Pose T_base_root_;
  Eigen::VectorXd q_;
};

/// Joint positions that bring the tool to a pose, cycle by cycle, by inverse kinematics: no joint
/// moves faster than its limit of velocity.
class Ros2JointCommand {
 public:
  /// See the constructor of Ros2ToolJoints.
  Ros2JointCommand(const RobotModel& model, std::size_t base, std::size_t tip);

  /// The names of the joints that move the tool, in the order of `positions`.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The next cycle begins at these positions [rad or m] of all the model's coordinates.
  void restart(const Eigen::VectorXd& q) { q_ = q; }
  /// Moves on towards the pose for `dt` [s]; how far the tip is from it after that [m].
  double follow(const Pose& T_base_tool, double dt);
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }

 private:
  InverseKinematics inverse_kinematics_;
  std::vector<std::string> names_;
  std::vector<Eigen::Index> coordinates_;  ///< of the names
  std::vector<double> positions_;
  Pose T_root_base_;
  Eigen::VectorXd q_;
};

/// The same description, for commands.
[[nodiscard]] Expected<Ros2JointCommand> read_joint_command(const Ros2Setup& setup);

/// Reads the description that `setup` names. An Error where it can't be read, or has no such links.
[[nodiscard]] Expected<Ros2ToolJoints> read_tool_joints(const Ros2Setup& setup);

}  // namespace pcavr
