// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// The corners of one tag in one image.
struct SeenCorners {
  std::size_t tag = 0;
  std::array<Eigen::Vector2d, 4> pixels;
  double corner_std = 0.0;  ///< [px]
  bool is_used = true;
};

/// One image; its camera's pose is among the unknowns.
struct LayoutView {
  std::size_t frame = 0;
  Pose T_camera_layout = {};
  std::vector<SeenCorners> seen = {};

  [[nodiscard]] std::size_t used() const;
};

/// Tags and cameras in the frame of one tag, the datum, which stays where it is.
struct LayoutProblem {
  CameraModel camera;
  std::vector<double> sizes = {};       ///< [m] by tag
  std::vector<Pose> T_layout_tag = {};  ///< by tag
  std::size_t datum = 0;
  std::vector<LayoutView> views = {};

  /// Residual of the tag's corners [standard deviations], squared, mean over the corners; infinite
  /// behind the camera.
  [[nodiscard]] double mean_square(const LayoutView& view, const SeenCorners& seen) const;
};

/// Levenberg-Marquardt with Huber weights over all tags but the datum and all cameras. False where
/// the corners do not determine the tags.
[[nodiscard]] bool fit_layout(LayoutProblem& problem);

/// Covariance of the tags' twists at the fit, 6 rows a tag, zero for the datum.
struct LayoutCovariance {
  Eigen::MatrixXd matrix;
  double variance_factor = 1.0;  ///< of the residuals against their stated stds; in `matrix`
  double correlation = 1.0;      ///< by successive views; in `matrix`
};
[[nodiscard]] LayoutCovariance layout_covariance(const LayoutProblem& problem);

}  // namespace pcavr
