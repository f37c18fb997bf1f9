// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pose.hpp"

#include "perception/marker/tag_plane.hpp"

namespace pcavr {

/// One tag of a body and its measurements.
struct SeenTag {
  Pose T_body_marker;
  double size = 0.0;                            ///< [m]
  std::array<Eigen::Vector3d, 4> corners_body;  ///< [m]
  std::array<Eigen::Vector2d, 4> pixels;        ///< [px]
  double corner_std = 0.0;                      ///< of one pixel coordinate [px]
  std::optional<PlaneMeasurement> plane = {};
  bool is_used = true;
};

struct BodyPoseProblem {
  CameraModel camera;
  std::vector<SeenTag> tags;
};

/// A refined pose with its residuals.
struct RefinedPose {
  Pose T_camera_body;
  double cost = 0.0;       ///< robust sum of squared normalised residuals, over the used tags
  double pixel_rms = 0.0;  ///< [px] of the used tags' corners, per corner
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in body axes
};

/// Huber's loss of a residual in standard deviations: its square up to 2, then linear.
[[nodiscard]] double huber_loss(double residual);

/// The weight of a residual in standard deviations that makes least squares follow that loss.
[[nodiscard]] double huber_weight(double residual);

/// d(pixel)/d(p_camera), by central differences of the lens model on z = 1.
[[nodiscard]] Eigen::Matrix<double, 2, 3> projection_jacobian(const CameraModel& camera,
                                                              const Eigen::Vector3d& p_camera);

/// Root mean square reprojection error of the corners of one tag [px]; infinite behind the camera.
[[nodiscard]] double corner_rms(const BodyPoseProblem& problem, const SeenTag& tag,
                                const Pose& T_camera_body);

/// Robust cost of the corners and depth of one tag: the sum of Huber losses.
[[nodiscard]] double tag_cost(const BodyPoseProblem& problem, const SeenTag& tag,
                              const Pose& T_camera_body);

/// Levenberg-Marquardt with Huber weights (IRLS) over the used tags, from `start`; nothing if a tag
/// is behind the camera or the pose is not determined.
[[nodiscard]] std::optional<RefinedPose> refine_body_pose(const BodyPoseProblem& problem,
                                                          const Pose& start);

}  // namespace pcavr
