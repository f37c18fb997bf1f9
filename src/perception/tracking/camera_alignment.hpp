// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"

#include "camera_surface.hpp"
#include "camera_verification.hpp"

namespace pcavr::tracking {

/// A landmark of the model that was matched in the frame's colour image.
struct FeatureMatch {
  Eigen::Vector3d p_model;   ///< [m]
  Eigen::Vector2d ray;       ///< of the match, undistorted, on the plane z = 1
  std::size_t landmark = 0;  ///< index of the landmark
  /// Derivative of the lens distortion at `ray`: converts small offsets on z = 1 to distorted ones.
  Eigen::Matrix2d lens_jacobian = Eigen::Matrix2d::Identity();
};

struct AlignmentInput {
  const CellGrid* grid = nullptr;
  const Surface* model = nullptr;
  const InverseDepth* frame = nullptr;
  const std::vector<FeatureMatch>* features = nullptr;
  double focal_length = 0.0;  ///< of the full image [px]
  bool has_distortion = false;
  DepthNoise noise = {};
  /// Pose of the colour camera at the colour stamp in the depth camera's at the depth stamp.
  Pose T_depth_color = {};
};

/// Pose of a frame in a model, and the quality of the fit.
struct Alignment {
  Pose T_model_frame;
  Matrix6d information = Matrix6d::Zero();  ///< of T * exp([v; w]); accounts for correlated noise
  int surface_in_view = 0;            ///< cells of the frame that fall onto the model's surface
  int surface_matched = 0;            ///< inliers: of these, the ones within the noise
  double surface_rms = 0.0;           ///< point to plane, of the matched cells [m]
  double overlap = 0.0;               ///< surface_in_view over the frame's cells
  int features = 0;                   ///< all matches
  int features_matched = 0;           ///< inliers of the final pose
  std::vector<std::size_t> inliers;   ///< landmarks consistent with the pose
  std::vector<std::size_t> outliers;  ///< the other matched landmarks
  Evidence evidence;                  ///< of the images, by match()

  /// Whether the pose can be used: well conditioned, and enough inliers.
  [[nodiscard]] bool is_valid(const CameraTrackerOptions& options = {}) const;
};

/// Point-to-plane ICP with projective data association [Newcombe et al. 2011 (KinectFusion), eq. 16
/// to 24] on all cells, together with the reprojection errors of the features, by robust
/// Gauss-Newton (IRLS) from `start`. Bitwise identical for any Parallelism.
[[nodiscard]] Alignment align(const AlignmentInput& input, const Pose& start,
                              Parallelism parallelism);

/// The pose from the features alone, from `start`, by graduated non-convexity: the scale of the
/// robust loss is reduced in steps from `initial_scale` [px]. An initial guess for align.
[[nodiscard]] Pose align_features(const AlignmentInput& input, const Pose& start,
                                  double initial_scale);

}  // namespace pcavr::tracking
