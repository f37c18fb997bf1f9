// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/robots/robot/inverse_kinematics.hpp"
#include "pcavr/robots/robot/robot_collision.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/robots/robot/options.cpp for meanings, ranges and defaults.
struct ArmFollowerOptions {
  ArmFollowerOptions();
  double stop_distance;   ///< [m]
  double shown_distance;  ///< [m]
  InverseKinematicsOptions inverse_kinematics;
};
/// The options "robot.arm", without those of the inverse kinematics.
[[nodiscard]] OptionSection section_of(ArmFollowerOptions& options);

/// The state of the arm after one cycle.
struct ArmState {
  Eigen::VectorXd q;                   ///< [rad or m]
  std::optional<NearestPair> nearest;  ///< within `shown_distance`; frame: the robot's base
  bool is_stopped = false;  ///< the command was not followed: it would have brought `nearest`
                            ///< closer than `stop_distance`
  bool is_reached = false;  ///< the tip is where it was commanded to be
};

/// Moves an arm so that its tip follows a point, at the orientation of the start, and stops it
/// before a link gets closer than `stop_distance` to another link, or to a surface: motions that
/// lead away from there, or along, are possible. One call a millisecond; no call allocates after
/// the setup. Frame: the robot's base. Threads: one at a time per object.
class ArmFollower {
 public:
  /// `meshes` by link (LinkMeshes::of_link). Throws ContractError for wrong sizes.
  ArmFollower(const RobotModel& model, const std::vector<TriangleMesh>& meshes, std::size_t tip,
              const Eigen::VectorXd& q_start, const ArmFollowerOptions& options = {});
  ArmFollower(ArmFollower&&) noexcept;
  ArmFollower& operator=(ArmFollower&&) noexcept;
  ~ArmFollower();

  /// See RobotCollision. Surfaces may be placed anew before each cycle.
  std::size_t add_surface(const TriangleMesh& mesh);
  void place_surface(std::size_t surface, const Pose& T_base_surface);

  /// Back to the start.
  void reset();
  /// Moves on by `dt` [s] > 0 towards `p_base_tip`, no faster than the joints' limits.
  const ArmState& follow(const Eigen::Vector3d& p_base_tip, double dt);

  [[nodiscard]] const ArmState& state() const;
  [[nodiscard]] Pose T_base_tip() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
