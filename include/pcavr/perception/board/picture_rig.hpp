// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/perception/board/camera_calibration.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

/// A picture of the board, and the flange's pose in base that the arm stated then.
struct ArmPicture {
  BoardView board;
  Pose T_base_flange = {};
};

struct PictureRigOptions {
  HandEyeOptions hand_eye = {};
  /// The camera; empty: its intrinsics are estimated from the same pictures.
  std::optional<CameraModel> camera = {};
  CameraCalibrationOptions intrinsics = {};
};

/// What one picture says of the arm.
struct PictureResidual {
  std::string view;
  double pixel_rms = 0.0;   ///< [px] with the pose of the flange that the picture shows
  double board_mean = 0.0;  ///< [m] of the points on the board, with the arm's own pose
  Pose T_base_flange = {};  ///< that the picture and the arm show together
  Pose T_base_camera = {};
  double arm_position = 0.0;  ///< [m] of the flange, from where the arm said
  double arm_rotation = 0.0;  ///< [rad]
};

/// Mean and standard deviation of distances [m], and their maximum.
struct DistanceSpread {
  double mean = 0.0, std = 0.0, max = 0.0;
};

struct PictureRig {
  HandEyeResult hand_eye = {};  ///< camera, board, cause and notes by the pictures
  CameraModel camera = {};
  bool is_camera_estimated = false;
  std::vector<double> camera_stds = {};  ///< as CameraCalibration has them; empty: given
  double pixel_noise = 0.0;              ///< [px] std of a coordinate
  double arm_position_std = 0.0;         ///< [m] of a coordinate of the flange
  double arm_rotation_std = 0.0;         ///< [rad] about an axis
  std::vector<PictureResidual> views = {};
  /// Points on the board with the arm's own poses: of the fitted views, and of each by the others.
  DistanceSpread fitted = {}, left_out = {};
};

/// Finds where camera and board are from pictures of one fixed board: poses of the board in each
/// (its turn, where it looks alike turned, by the arm's rotations), calibrate_hand_eye() for start,
/// faults and outliers, then one fit of camera, board, the arm's poses with their noise, and the
/// intrinsics, if they are not given, to all pixels. Errors as calibrate_hand_eye() and
/// calibrate_camera() have them.
[[nodiscard]] Expected<PictureRig> calibrate_picture_rig(const std::vector<ArmPicture>& views,
                                                         int width, int height, const Board& board,
                                                         const PictureRigOptions& options = {});

}  // namespace pcavr
