// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"

#include "camera_surface.hpp"

namespace pcavr::tracking {

/// One of two views whose relative pose is judged.
struct View {
  const InverseDepth* inverse_depth = nullptr;
  cv::Mat texture;     ///< by cell_texture
  Pose T_depth_color;  ///< colour camera in the depth camera
};

/// Evidence of two views about the pose between them, whatever it was fitted to.
struct Evidence {
  /// Share of the common surface that one view sees where the other one looked through: impossible,
  /// but for things that moved.
  double contradicted = 0.0;
  /// Correlation of the texture where both see one surface; nothing if there is too little to
  /// compare. Unlike depth, it also depends on the position along a plane.
  std::optional<double> correlation;

  [[nodiscard]] bool is_plausible(const CameraTrackerOptions& options) const;
};

/// Grey values of each cell [grey levels], without shading and pixel noise: details of 3 to 27
/// cells.
[[nodiscard]] cv::Mat cell_texture(const CellGrid& grid, const cv::Mat& gray);

[[nodiscard]] Evidence compare_views(const CellGrid& grid, const DepthNoise& noise,
                                     const View& model, const View& frame,
                                     const Pose& T_model_frame);

}  // namespace pcavr::tracking
