// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

/// Points of the board in one picture, and where the arm says that its flange was.
struct BundleView {
  std::vector<Eigen::Vector3d> points_board = {};  ///< [m]
  std::vector<Eigen::Vector2d> pixels = {};
  Pose T_base_flange = {};
};

/// What the pictures follow from. Without an arm carrier and board have the identity, and
/// T_base_flange is the pose of the camera in the board's frame.
struct BundleModel {
  CameraMount mount = CameraMount::arm;
  CameraModel camera = {};
  Pose T_mount_camera = {};  ///< in flange, or in base
  Pose T_fixed_board = {};   ///< in base, or in flange
  double board_scale = 1.0;
  std::vector<Pose> T_base_flange = {};  ///< of each view, corrected

  [[nodiscard]] Pose T_camera_board(const Pose& T_base_flange_of_view) const;
};

/// Parameters that all views share, in this order: twists of T_mount_camera and T_fixed_board,
/// board_scale, fx, fy, cx, cy, up to eight coefficients of the lens.
inline constexpr int kScaleParameter = 12;
inline constexpr int kCameraParameter = 13;
inline constexpr int kLensParameter = 17;
inline constexpr int kSharedParameters = 25;

struct BundleOptions {
  bool with_rig = true;  ///< camera and board on the arm, whose poses have noise; else free poses
  bool with_scale = false;
  bool with_camera = false;
  std::vector<int> lens = {};  ///< indices of the coefficients that are estimated
  bool with_noise = true;      ///< estimates the noise, else keeps the given one
  bool with_arm_noise = true;  ///< also the arm's
};

/// Standard deviations.
struct BundleNoise {
  double pixel = 1.0;          ///< [px] of a coordinate
  double arm_position = 5e-3;  ///< [m] of a coordinate of the flange's position
  double arm_rotation = 5e-3;  ///< [rad] about an axis of the flange
};

struct BundleFit {
  BundleModel model = {};
  BundleNoise noise = {};
  /// Of all shared parameters, 0 where not estimated: by the noise, but not less than the scatter
  /// of the views shows, each left out in turn [Efron 1982, jackknife].
  Eigen::MatrixXd covariance = {};
  std::vector<Matrix6d> camera_board_covariance = {};  ///< of each picture alone, by its pixels
  double arm_freedom = 0.0;  ///< [1] coordinates that show the arm's noise
  double pixel_rms = 0.0;    ///< [px] of distances, all points
  std::vector<double> view_rms = {};
};

/// Fits all that the options free to the pixels, by Levenberg-Marquardt with Huber's loss, the
/// views' poses eliminated [Triggs et al. 2000, 6.1], and the noise by the evidence [MacKay 1992],
/// which here is restricted likelihood: pixels and arm are separated, since a picture alone
/// shows its own noise.
[[nodiscard]] BundleFit fit_bundle(const std::vector<BundleView>& views, const BundleModel& start,
                                   const BundleNoise& noise, const BundleOptions& options);

/// [px] Distances of a view's points from where the model with this pose of the flange puts them.
[[nodiscard]] std::vector<double> pixel_errors(const BundleModel& model, const BundleView& view,
                                               const Pose& T_base_flange);
/// [m] Distances on the board between its points and where the pixels' rays meet it.
[[nodiscard]] std::vector<double> board_errors(const BundleModel& model, const BundleView& view,
                                               const Pose& T_base_flange);

}  // namespace pcavr
