// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/scene_arm.hpp"

#include <utility>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr {
namespace {

constexpr char kHint[] = "build the scene again";

Error unknown_link(const SceneManifest& scene, const std::string& name) {
  return {.message = "the robot has no link '" + name + "'",
          .file = (scene.folder / scene.robot->urdf).string(),
          .hint = kHint};
}

/// The model with the joints of the manifest, in its order.
Expected<RobotModel> model_of(const SceneManifest& scene) {
  const std::filesystem::path file = scene.folder / scene.robot->urdf;
  const Expected<RobotModel> described = read_urdf(file);
  if (!described) return described.error();
  if (scene.robot->joints.empty()) return *described;
  JointLog log;
  log.joints = scene.robot->joints;
  Expected<MatchedRobot> matched = match_joints(log, *described);
  if (!matched) {
    return Error{.message = matched.error().message, .file = file.string(), .hint = kHint};
  }
  return std::move(matched->model);
}

}  // namespace

Expected<std::optional<SceneArm>> read_scene_arm(const SceneManifest& scene) {
  if (!scene.robot) return std::optional<SceneArm>();
  const SceneRobotEntry& entry = *scene.robot;
  Expected<RobotModel> model = model_of(scene);
  if (!model) return model.error();
  SceneArm arm{.model = std::move(*model),
               .T_base_robot = entry.T_base_robot,
               .tip = 0,
               .q = Eigen::Map<const Eigen::VectorXd>(
                   entry.position.data(), static_cast<Eigen::Index>(entry.position.size())),
               .link_meshes = {}};
  if (entry.position.size() != arm.model.dof) {
    return Error{.message = "states " + std::to_string(entry.position.size()) +
                            " positions for an arm of " + std::to_string(arm.model.dof) + " joints",
                 .file = (scene.folder / "scene.yaml").string(),
                 .place = "robot.position",
                 .hint = kHint};
  }
  const std::optional<std::size_t> tip = arm.model.link_index(entry.tip);
  if (!tip) return unknown_link(scene, entry.tip);
  arm.tip = *tip;
  arm.link_meshes.resize(arm.model.links.size());
  for (const SceneRobotEntry::Link& link : entry.links) {
    const std::optional<std::size_t> index = arm.model.link_index(link.name);
    if (!index) return unknown_link(scene, link.name);
    Expected<TriangleMesh> mesh = read_mesh(scene.folder / link.mesh);
    if (!mesh) return mesh.error();
    arm.link_meshes[*index] = std::move(*mesh);
  }
  return std::optional<SceneArm>(std::move(arm));
}

LiveArm make_live_arm(const SceneArm& arm, const SceneWorld& world,
                      const ArmFollowerOptions& options) {
  RobotDynamics kinematics(arm.model);
  kinematics.forward_kinematics(arm.q);
  const Pose T_robot_base = arm.T_base_robot.inverse();
  Eigen::VectorXd q_start = arm.q;
  InverseKinematics inverse(arm.model, arm.tip, options.inverse_kinematics);
  const IkResult found = inverse.solve(
      Pose(kinematics.T_base_link(arm.tip).rotation(), T_robot_base * world.p_base_tool_start),
      q_start);
  if (found.status != IkStatus::kReached) q_start = arm.q;
  LiveArm live{ArmFollower(arm.model, arm.link_meshes, arm.tip, q_start, options), arm.T_base_robot,
               !world.model.world.static_mesh_base.triangles.empty()};
  live.tip = arm.tip;
  if (live.has_scan) {
    const std::size_t scan = live.follower.add_surface(world.model.world.static_mesh_base);
    live.follower.place_surface(scan, T_robot_base);
  }
  for (const WorldBody& body : world.model.world.bodies) {
    const std::size_t surface = live.follower.add_surface(body.model.mesh_object);
    live.follower.place_surface(surface, T_robot_base * body.T_base_object);
  }
  if (!world.model.guard_mesh_base.triangles.empty()) {
    const std::size_t guards = live.follower.add_surface(world.model.guard_mesh_base);
    live.follower.place_surface(guards, T_robot_base);
  }
  live.follower.reset();
  return live;
}

void drive_by_torques(LiveArm& arm, const RobotModel& robot, const std::vector<JointFit>& friction,
                      const DrivenArmOptions& options) {
  arm.driven.emplace(robot, friction, options);
  arm.driven->reset(arm.follower.state().q);
  arm.external = Eigen::VectorXd::Zero(arm.follower.state().q.size());
  arm.jacobian = Matrix6Xd::Zero(6, arm.external.size());
}

}  // namespace pcavr
