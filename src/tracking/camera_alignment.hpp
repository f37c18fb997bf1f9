// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/pose.hpp"

#include "camera_surface.hpp"

namespace pcavr::tracking {

/// A point of the model that was found again in the frame's colour image.
struct FeatureMatch {
  Eigen::Vector3d p_model;   ///< [m]
  Eigen::Vector2d ray;       ///< where it was found, undistorted, on the plane z = 1
  std::size_t landmark = 0;  ///< whose it is
  /// What the lens makes of small offsets from `ray`: with distortion, pixels are not of one size.
  Eigen::Matrix2d lens = Eigen::Matrix2d::Identity();
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

/// How a frame lies against a model, and how well they agree.
struct Alignment {
  Pose T_model_frame;
  Matrix6d information = Matrix6d::Zero();  ///< of T * exp([v; w]), correlated noise allowed for
  int surface_in_view = 0;            ///< cells of the frame that fall onto the model's surface
  int surface_matched = 0;            ///< of these, the ones that lie on it within the noise
  double surface_rms = 0.0;           ///< point to plane, of the matched cells [m]
  double overlap = 0.0;               ///< surface_in_view over the frame's cells
  int features = 0;                   ///< offered
  int features_matched = 0;           ///< of these, the ones that agree with the pose
  std::vector<std::size_t> agreeing;  ///< landmarks found where the pose puts them
  std::vector<std::size_t> straying;  ///< landmarks found elsewhere

  /// The frame was placed: well conditioned, and what it shows agrees with the model.
  [[nodiscard]] bool is_sound() const;
};

/// Robust Gauss-Newton on the point-to-plane distances of all cells with projective association
/// [Newcombe et al. 2011 (KinectFusion), eq. 16 to 24] and the reprojections of the features
/// together, from `start`. The same bits for any Parallelism.
[[nodiscard]] Alignment align(const AlignmentInput& input, const Pose& start,
                              Parallelism parallelism);

/// The pose that the features alone ask for, from `start`, the scale of outliers brought down in
/// steps from `coarsest_pixels`; a start for align.
[[nodiscard]] Pose align_features(const AlignmentInput& input, const Pose& start,
                                  double coarsest_pixels);

}  // namespace pcavr::tracking
