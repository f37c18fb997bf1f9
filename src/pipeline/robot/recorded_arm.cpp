// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recorded_arm.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"
#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot/urdf.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr {
namespace {

constexpr char kJoints[] = "joints.csv";

Expected<std::size_t> tip_of(const RobotModel& model, const std::optional<std::string>& name,
                             const Recording& recording) {
  if (!name) return default_tip(model);
  if (const std::optional<std::size_t> link = model.link_index(*name)) return *link;
  return Error{.message = "the robot has no link '" + *name + "'",
               .file = (recording.folder / "recording.yaml").string(),
               .place = "robot.tip",
               .hint = "name a link of " + model.file.filename().string()};
}

/// The model with the logged joints, and the log in their order.
Expected<void> add_log(const Recording& recording, RecordedArm& arm) {
  Expected<JointLog> log = read_joint_log(recording.folder, false);
  if (!log) return log.error();
  Expected<MatchedRobot> matched = match_joints(*log, arm.model);
  if (!matched) {
    Error error = matched.error();
    error.file = (recording.folder / kJoints).string();
    return error;
  }
  arm.model = std::move(matched->model);
  arm.log = reordered(*log, matched->columns);
  return {};
}

}  // namespace

std::optional<Eigen::VectorXd> RecordedArm::position_at(Stamp stamp, Duration max_gap) const {
  const auto next = std::lower_bound(log.stamps.begin(), log.stamps.end(), stamp);
  if (next == log.stamps.end()) return std::nullopt;
  const auto row = static_cast<Eigen::Index>(next - log.stamps.begin());
  if (*next == stamp) return Eigen::VectorXd(log.position.row(row).transpose());
  if (row == 0 || *next - *(next - 1) > max_gap) return std::nullopt;
  const double part = to_seconds(stamp - *(next - 1)) / to_seconds(*next - *(next - 1));
  return Eigen::VectorXd(
      ((1.0 - part) * log.position.row(row - 1) + part * log.position.row(row)).transpose());
}

Eigen::VectorXd RecordedArm::last_position() const {
  if (log.position.rows() > 0) return log.position.row(log.position.rows() - 1).transpose();
  Eigen::VectorXd q = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.dof));
  for (const std::size_t i : model.coordinate_joints()) {
    const RobotJoint& joint = model.joints[i];
    double& value = q[static_cast<Eigen::Index>(joint.coordinate)];
    if (joint.limits.lower) value = std::max(value, *joint.limits.lower);
    if (joint.limits.upper) value = std::min(value, *joint.limits.upper);
  }
  return q;
}

Expected<std::optional<RecordedArm>> read_recorded_joints(const Recording& recording) {
  const std::optional<RobotEntry>& entry = recording.manifest.robot;
  if (!entry) return std::optional<RecordedArm>();
  const std::filesystem::path file = recording.folder / entry->urdf;
  Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<RobotModel> model = parse_urdf(*text, file);
  if (!model) return model.error();
  const Expected<std::size_t> tip = tip_of(*model, entry->tip, recording);
  if (!tip) return tip.error();
  RecordedArm arm{.model = std::move(*model),
                  .urdf = std::move(*text),
                  .T_base_robot = entry->T_base_robot,
                  .tip = *tip,
                  .link_meshes = {},
                  .log = {}};
  if (!recording.joints.empty()) {
    if (const Expected<void> added = add_log(recording, arm); !added) return added.error();
  }
  return std::optional<RecordedArm>(std::move(arm));
}

Expected<std::optional<RecordedArm>> read_recorded_arm(const Recording& recording,
                                                       const Observer& observer) {
  Expected<std::optional<RecordedArm>> read = read_recorded_joints(recording);
  if (!read || !*read) return read;
  RecordedArm& arm = **read;
  Expected<LinkMeshes> meshes = link_meshes(arm.model);
  if (!meshes) return meshes.error();
  for (const Error& warning : meshes->warnings) observer.on_warning(warning.to_string());
  arm.link_meshes = std::move(meshes->of_link);
  if (recording.joints.empty()) {
    observer.on_warning("the manifest has a robot, but there is no joints.csv: it is shown at 0");
  }
  return read;
}

SceneRobot scene_robot_of(const RecordedArm& arm) {
  SceneRobot robot{.urdf = arm.urdf,
                   .T_base_robot = arm.T_base_robot,
                   .tip = arm.model.links[arm.tip].name,
                   .joints = {},
                   .position = {},
                   .links = {}};
  const Eigen::VectorXd q = arm.last_position();
  for (const std::size_t joint : arm.model.coordinate_joints()) {
    robot.joints.push_back(arm.model.joints[joint].name);
  }
  robot.position.assign(q.begin(), q.end());
  RobotDynamics kinematics(arm.model);
  kinematics.forward_kinematics(q);
  for (std::size_t i = 0; i < arm.link_meshes.size(); ++i) {
    if (arm.link_meshes[i].triangles.empty()) continue;
    robot.links.push_back({arm.model.links[i].name, arm.link_meshes[i],
                           arm.T_base_robot * kinematics.T_base_link(i)});
  }
  return robot;
}

ArmMask::ArmMask(const RecordedArm* arm, const PerceptionOptions& options)
    : arm_(arm), options_(options) {
  if (arm_ == nullptr) return;
  kinematics_.emplace(arm_->model);
  for (std::size_t i = 0; i < arm_->link_meshes.size(); ++i) {
    if (arm_->link_meshes[i].triangles.empty()) continue;
    surfaces_.emplace_back(i, SurfaceQuery(arm_->link_meshes[i]));
  }
}

void ArmMask::mark(const RgbdFrame& frame, const CameraModel& depth_camera,
                   const Pose& T_base_camera, MaskImage& mask) {
  if (arm_ == nullptr) return;
  const Duration max_gap(std::llround(options_.masks.max_tool_gap * 1e9));
  const std::optional<Eigen::VectorXd> q = arm_->position_at(frame.depth_stamp, max_gap);
  if (!q) return;
  kinematics_->forward_kinematics(*q);
  const Pose T_camera_robot = T_base_camera.inverse() * arm_->T_base_robot;
  for (const auto& [link, surface] : surfaces_) {
    mask_body(surface, T_camera_robot * kinematics_->T_base_link(link), depth_camera, frame.depth,
              options_.depth_noise, options_.masks.body_margin, mask);
  }
}

}  // namespace pcavr
