// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/perception/board/board.hpp"
#include "pcavr/perception/board/board_views.hpp"

namespace pcavr {

struct CameraCalibrationOptions {
  LensModel lens = LensModel::plumb_bob;
  /// Of plumb_bob: k3, too, which only lenses with a strong distortion show.
  bool with_k3 = false;

  friend bool operator==(const CameraCalibrationOptions&,
                         const CameraCalibrationOptions&) = default;
};

struct CalibratedView {
  std::string name;
  Pose T_camera_board = {};
  double rms = 0.0;         ///< [px] of the points' distances from where they are expected
  double tilt = 0.0;        ///< [rad] of the board's normal against the line of sight
  bool is_outlier = false;  ///< not fitted
};

/// A view that is not there, and would reduce the largest error of the camera most.
struct MissingView {
  std::string text = {};  ///< "the board in the upper left, turned by 40 degrees about ..."
  double std_now = 0.0, std_expected = 0.0;  ///< [px] as CameraCalibration::pixel_std
};

inline constexpr int kCoverageColumns = 8, kCoverageRows = 6;

struct CameraCalibration {
  CameraModel camera = {};
  /// Of fx, fy, cx, cy [px] and the lens's coefficients; 0 of coefficients that are not estimated.
  std::vector<double> stds = {};
  Eigen::MatrixXd covariance = {};
  double pixel_rms = 0.0;  ///< [px] of distances, over all fitted points
  /// [px] rms of views that were not fitted, whose own pose is, over five parts of the views.
  std::optional<double> held_out_rms = {};
  double noise = 0.0;  ///< [px] std of a coordinate
  /// [px] Std of a point's place by the camera's parameters alone, where in the image it is
  /// largest.
  double pixel_std = 0.0;
  std::vector<CalibratedView> views = {};
  std::array<int, kCoverageColumns * kCoverageRows> coverage{};  ///< points by cell, row by row
  double covered = 0.0;  ///< part of the cells that have points
  std::optional<MissingView> missing = {};
  std::vector<std::string> notes = {};  ///< for the user, the main ones first
};

/// Finds a camera's intrinsics from views of a flat board [Zhang 2000], with Huber's loss. Stds
/// are the larger of those by the pixels' noise and by the scatter between views, which includes
/// what the model does not: a board that is not flat, blur. An Error with fewer than three views,
/// and where the views don't show the focal length.
[[nodiscard]] Expected<CameraCalibration> calibrate_camera(
    const BoardViews& views, const Board& board, const CameraCalibrationOptions& options = {});

}  // namespace pcavr
