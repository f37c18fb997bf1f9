// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/perception/board/camera_calibration.hpp"

#include "perception/board/bundle.hpp"

namespace pcavr {

/// Views of a board without an arm, with a start for the camera and their poses.
struct CameraBundle {
  std::vector<BundleView> views = {};
  BundleModel start = {};
  std::vector<std::size_t> given = {};  ///< index of each view in BoardViews

  [[nodiscard]] static CameraBundle of_views(const BoardViews& views, const Board& board,
                                             LensModel lens);
  /// Some of the views, with their poses by this camera.
  [[nodiscard]] CameraBundle of(const std::vector<std::size_t>& indices,
                                const CameraModel& camera) const;
  [[nodiscard]] std::vector<std::size_t> indices() const;
};

/// The camera's parameters that are estimated.
[[nodiscard]] BundleOptions camera_freedom(const CameraCalibrationOptions& options);

}  // namespace pcavr
