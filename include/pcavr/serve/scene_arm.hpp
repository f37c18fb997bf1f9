// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/robots/arm/driven_arm.hpp"
#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/robots/robot/robot_model.hpp"
#include "pcavr/serve/scene_world.hpp"

namespace pcavr {

/// The arm of a scene, read from its files.
struct SceneArm {
  RobotModel model;  ///< with the joints of the scene's manifest; all others are locked at 0
  Pose T_base_robot;
  std::size_t tip = 0;                    ///< link
  Eigen::VectorXd q;                      ///< at the recording's end
  std::vector<TriangleMesh> link_meshes;  ///< by link; empty: no surface
};

/// Nothing where the scene has no arm. Errors: a file that is missing or invalid, joints or links
/// that the description does not have.
[[nodiscard]] Expected<std::optional<SceneArm>> read_scene_arm(const SceneManifest& scene);

/// An arm that follows the tool of a live world, and where its surfaces are.
struct LiveArm {
  ArmFollower follower;
  Pose T_base_robot;
  /// Surface 0 is the static mesh; else it is the first body. The guards come after the bodies.
  bool has_scan = false;
  /// Present: the arm moves by its own dynamics towards the follower's joints, its tip is the tool,
  /// and the tool's forces act on it.
  std::optional<DrivenArm> driven = {};
  std::size_t tip = 0;            ///< link
  Matrix6Xd jacobian = {};        ///< of the tip; of `driven`
  Eigen::VectorXd external = {};  ///< [N m] of the tool's force; of `driven`
};

/// Lets the arm move by torques: `robot` has the joints of the scene's arm with identified
/// inertias; `friction` as DrivenArm's. Starts at rest at the follower's position.
void drive_by_torques(LiveArm& arm, const RobotModel& robot, const std::vector<JointFit>& friction,
                      const DrivenArmOptions& options = {});

/// Starts where the tool starts as far as the arm reaches it, else where the recording ended. The
/// scene's static mesh and its bodies are what it must not hit.
[[nodiscard]] LiveArm make_live_arm(const SceneArm& arm, const SceneWorld& world,
                                    const ArmFollowerOptions& options = {});

}  // namespace pcavr
