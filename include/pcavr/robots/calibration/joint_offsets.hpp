// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

/// The flange, and how it moves with each joint that has an offset, from the base on.
struct ArmPose {
  Pose T_base_flange = {};
  /// [v; omega] of the flange's origin in base's axes, by unit speed of each joint.
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian_base = {};
};

/// Where the arm is in a view, with offsets [rad] added to the joint positions that were read.
using ArmModel = std::function<ArmPose(std::size_t view, const Eigen::VectorXd& offsets)>;

struct JointOffsetOptions {
  /// [rad] Before the views were seen: encoders are set to a mark, or a stop, to a few tenths of a
  /// degree; 0.5 degrees move a tip at 0.8 m by 7 mm.
  double std = 0.5 * std::numbers::pi / 180.0;

  friend bool operator==(const JointOffsetOptions&, const JointOffsetOptions&) = default;
};

struct JointOffset {
  std::string joint = {};
  double value = 0.0;    ///< [rad] to add to the position that is read
  double std = 0.0;      ///< [rad]
  bool is_held = false;  ///< the motion does not show it: 0, as the arm has it
};

/// A rig of which the arm's joint offsets were fitted with the camera and the board.
struct ArmHandEyeResult {
  /// With the arm's poses by the offsets; the covariances contain what is not known of these.
  HandEyeResult hand_eye = {};
  std::vector<JointOffset> offsets = {};  ///< from the base on
  /// As the arm has its poses; its held_out_rms is of the views that `hand_eye` fits.
  HandEyeResult without = {};
};

/// Does what calibrate_hand_eye does, with the offsets of the arm's revolute joints as more
/// parameters, each with a prior of zero mean. An offset of the first joint turns the whole arm, as
/// another pose of the board (or of the camera beside the arm) does, one of the last turns the
/// flange, as another pose of what it carries does: offsets of which the views show no more than
/// the prior are held at 0. `views` have the arm's poses without offsets, `joints` the names of the
/// jacobian's columns. Errors as of calibrate_hand_eye, and of fewer views than 4 and one for each
/// two joints, and rotations about one axis. Deterministic, thread-safe where `arm` is.
[[nodiscard]] Expected<ArmHandEyeResult> calibrate_hand_eye_and_arm(
    const std::vector<HandEyeView>& views, const ArmModel& arm,
    const std::vector<std::string>& joints, const HandEyeOptions& options = {},
    const JointOffsetOptions& offset_options = {});

/// One sentence: what the offsets are good for on unseen views.
[[nodiscard]] std::string describe_offsets(const ArmHandEyeResult& result);

}  // namespace pcavr
