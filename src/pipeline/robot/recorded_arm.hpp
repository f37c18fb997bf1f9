// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/scene.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

/// The arm of a recording: its description, its links' meshes and its logged joints.
struct RecordedArm {
  RobotModel model;  ///< the log's joints; all others are locked at 0
  std::string urdf;  ///< the description's text
  Pose T_base_robot;
  std::size_t tip = 0;                    ///< link
  std::vector<TriangleMesh> link_meshes;  ///< by link, in its frame; empty: no surface
  JointLog log;                           ///< columns in the model's order; may have no rows

  /// [rad or m], interpolated linearly; nothing outside of the log and in gaps of more than
  /// `max_gap`.
  [[nodiscard]] std::optional<Eigen::VectorXd> position_at(Stamp stamp, Duration max_gap) const;
  /// The last logged position; without a log 0, moved into the limits.
  [[nodiscard]] Eigen::VectorXd last_position() const;
};

/// Reads what read_recorded_arm() reads, without the links' meshes; nothing where the manifest has
/// no robot. Without `joints.csv` the model has all joints, and the log no rows.
[[nodiscard]] Expected<std::optional<RecordedArm>> read_recorded_joints(const Recording& recording);

/// Nothing where the manifest has no robot. Errors: a description or log that can't be read, joints
/// that are not the robot's, an unknown tip. Warnings go to the observer.
[[nodiscard]] Expected<std::optional<RecordedArm>> read_recorded_arm(const Recording& recording,
                                                                     const Observer& observer);

/// The robot as the scene shows it.
[[nodiscard]] SceneRobot scene_robot_of(const RecordedArm& arm);

/// Masks the links of the arm in each frame, at the joints' positions at the frame's stamp. Frames
/// outside of the log are not masked. Not thread-safe.
class ArmMask {
 public:
  /// `arm` (may be null) has to outlive this.
  ArmMask(const RecordedArm* arm, const PerceptionOptions& options);

  void mark(const RgbdFrame& frame, const CameraModel& depth_camera, const Pose& T_base_camera,
            MaskImage& mask);

 private:
  const RecordedArm* arm_;
  PerceptionOptions options_;
  std::optional<RobotDynamics> kinematics_;
  std::vector<std::pair<std::size_t, SurfaceQuery>> surfaces_;  ///< link, surface
};

}  // namespace pcavr
