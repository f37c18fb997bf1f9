// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/scene_joints.hpp"

#include "pcavr/pipeline/identify_robot.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"
#include "pcavr/serve/scene_arm.hpp"

namespace pcavr {

Expected<std::optional<JointLog>> read_scene_joints(const Recording& recording,
                                                    const SceneManifest& scene) {
  const Expected<std::optional<SceneArm>> arm = read_scene_arm(scene);
  if (!arm) return arm.error();
  if (!*arm || recording.joints.empty()) return std::optional<JointLog>();
  const Expected<JointLog> log = read_joint_log(recording.folder, false);
  if (!log) return log.error();
  const Expected<MatchedRobot> matched = match_joints(*log, (*arm)->model);
  if (!matched) return matched.error();
  if (matched->columns.size() != (*arm)->model.dof) {
    return Error{.message = "has other joints than the scene's arm",
                 .file = (recording.folder / "joints.csv").string(),
                 .hint = "replay the recording in the scene that was built from it"};
  }
  return std::optional<JointLog>(reordered(*log, matched->columns));
}

}  // namespace pcavr
