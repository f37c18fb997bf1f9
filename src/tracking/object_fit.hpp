// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/model/cad_model.hpp"

#include "tracking/object_normals.hpp"

namespace pcavr::tracking {

/// A tag's corner in its object and where it was seen.
struct CornerSight {
  Eigen::Vector3d p_object;
  Eigen::Vector2d on_unit_plane;  ///< the pixel without distortion, on z = 1
};

/// From where a corner is expected to where it was seen [px]; z of `p_camera` > 0.
[[nodiscard]] Eigen::Vector2d corner_offset(const CameraModel& camera, const CornerSight& corner,
                                            const Eigen::Vector3d& p_camera);

/// What is believed before looking: a Gaussian about a pose.
struct PosePrior {
  Pose T_camera_object;
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in object axes
};

/// All that a pose of one object in one frame has to explain. Keeps references.
struct FitProblem {
  const SurfaceQuery& surface_object;
  const SmoothNormals& normals_object;
  const CameraModel& camera;        ///< of the colour image, where the corners were found
  const CameraModel& depth_camera;  ///< the same on the depth image's grid
  const DepthImage& depth;
  const DepthNoise& noise;
  int max_samples = 1500;      ///< rays cast for each pose that is tried
  double corner_sigma = 0.15;  ///< [px]
  double depth_bias = 0.0;     ///< common to all pixels, one standard deviation at 1 m [m]
  std::vector<CornerSight> corners = {};
  /// The object's motion between the depth image and the colour image: maps its coordinates at the
  /// time of colour to those at the time of depth.
  Pose motion_to_color = {};
  std::optional<PosePrior> prior = {};
};

/// How the depth image agrees with the body where the pose says it should be seen; in samples.
struct ShapeAgreement {
  int explained = 0;     ///< on the surface, within the noise
  int contradicted = 0;  ///< measured behind the surface: the camera sees through the body
  int hidden = 0;        ///< measured in front of the surface: something covers the body
  double rms = 0.0;      ///< of the explained samples' distances along the ray [m]
  double chi = 0.0;      ///< the same in units of each sample's deviation; 1 is as expected
};

struct FitResult {
  Pose T_camera_object;
  Matrix6d corner_information = Matrix6d::Zero();  ///< of [v; w] in object axes
  Matrix6d depth_information = Matrix6d::Zero();   ///< the same; the common bias eliminated
  ShapeAgreement agreement;
  bool is_converged = false;
};

/// Maximum a posteriori pose by Gauss-Newton, with robust weights, on three kinds of residuals in
/// one system: reprojected corners; depth along the rays that meet the CAD surface, less one bias
/// common to all pixels (and, where no corner is seen, the body's outline in the depth image); the
/// prior. Tags so hold what depth does not observe, such as sliding along
/// the only face seen, and a biased sensor drags the body no further than `depth_bias` allows.
/// `capture` [m]: how far from the surface depth may lie at first and still be drawn to it.
[[nodiscard]] FitResult fit_object(const FitProblem& problem, const Pose& start_T_camera_object,
                                   double capture);

/// As fit_object judges a pose, without moving it.
[[nodiscard]] ShapeAgreement judge_shape(const FitProblem& problem, const Pose& T_camera_object);

}  // namespace pcavr::tracking
