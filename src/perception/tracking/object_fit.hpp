// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

#include "perception/tracking/object_normals.hpp"

namespace pcavr::tracking {

/// A tag's corner in its object and its observation in the image.
struct CornerObservation {
  Eigen::Vector3d p_object;
  Eigen::Vector2d ray;  ///< the undistorted pixel, on z = 1
};

/// Reprojection error: observed minus predicted pixel; z of `p_camera` > 0.
[[nodiscard]] Eigen::Vector2d reprojection_error(const CameraModel& camera,
                                                 const CornerObservation& corner,
                                                 const Eigen::Vector3d& p_camera);

/// Gaussian prior of the pose.
struct PosePrior {
  Pose T_camera_object;
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in object axes
};

/// The measurements of one object in one frame. Keeps references.
struct FitProblem {
  const SurfaceQuery& surface_object;
  const SmoothNormals& normals_object;
  const CameraModel& camera;        ///< of the colour image and the corners
  const CameraModel& depth_camera;  ///< the same at the depth image's resolution
  const DepthImage& depth;
  const ObjectTrackerOptions& options;
  std::vector<CornerObservation> corners = {};
  /// The object's motion between the depth image and the colour image: maps its coordinates at the
  /// time of colour to those at the time of depth.
  Pose motion_to_color = {};
  std::optional<PosePrior> prior = {};
};

/// Agreement of the depth image with the surface rendered at a pose; in samples.
struct ShapeAgreement {
  int inliers = 0;              ///< on the surface, within the noise
  int behind = 0;               ///< behind the surface: contradict the pose (free-space violation)
  int occluded = 0;             ///< in front of the surface: an occluder
  double rms = 0.0;             ///< of the inliers' residuals along the ray [m]
  double normalised_rms = 0.0;  ///< the same in units of each sample's std; 1 is expected
};

struct FitResult {
  Pose T_camera_object;
  Matrix6d corner_information = Matrix6d::Zero();  ///< of [v; w] in object axes
  Matrix6d depth_information = Matrix6d::Zero();   ///< the same; the common bias marginalised
  ShapeAgreement agreement;
  bool is_converged = false;
};

/// Maximum a posteriori (MAP) pose by robust Gauss-Newton (IRLS) on three kinds of residuals:
/// reprojection errors of the corners; depth along the rays that hit the CAD surface, minus a bias
/// common to all pixels (and, without corners, the occluding contour in the depth image); the
/// prior. Tags thus constrain what depth does not observe, such as sliding along the only visible
/// face, and the effect of a biased sensor is limited by
/// ObjectTrackerOptions::depth_bias. `capture_range` [m]: initial
/// distance from the surface within which depth counts as an inlier.
[[nodiscard]] FitResult fit_object(const FitProblem& problem, const Pose& start_T_camera_object,
                                   double capture_range);

/// Evaluates the agreement at a pose without optimising it.
[[nodiscard]] ShapeAgreement evaluate_shape(const FitProblem& problem, const Pose& T_camera_object);

}  // namespace pcavr::tracking
