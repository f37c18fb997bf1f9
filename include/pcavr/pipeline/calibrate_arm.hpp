// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/pipeline/calibrate.hpp"
#include "pcavr/robots/calibration/joint_offsets.hpp"

namespace pcavr {

/// A table of joint positions, and the arm that they are of.
struct ArmInput {
  std::string
      table;  ///< index, q_NAME: the number of the view, the joint's position (rad, or _deg)
  std::string urdf;
  std::string tip = {};  ///< the link that is the flange; empty: the chain's last
  bool skip_bad = false;
};

/// Views by the arm's description, without offsets, and the arm with them.
struct PairedArm {
  PairedPoses paired = {};
  std::vector<std::string> joints = {};  ///< revolute ones that carry the flange, from the base on
  ArmModel arm = {};                     ///< one call at a time
};

/// Reads the arm's views, and pairs them with those of the board by their number. Errors: a file
/// that can't be read, a joint that carries the flange and has no column, no number in common.
[[nodiscard]] Expected<PairedArm> read_arm_views(const ArmInput& robot, const PoseInput& camera);

/// What is added to a calibration file: `joint_offsets` with their stds.
[[nodiscard]] std::string format_joint_offsets(const ArmHandEyeResult& found);

}  // namespace pcavr
