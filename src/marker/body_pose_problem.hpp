// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/pose.hpp"

#include "marker/tag_plane.hpp"

namespace pcavr {

/// One tag of a body and what was seen of it.
struct SeenTag {
  Pose T_body_marker;
  double size = 0.0;                            ///< [m]
  std::array<Eigen::Vector3d, 4> corners_body;  ///< [m]
  std::array<Eigen::Vector2d, 4> pixels;        ///< [px]
  double sigma = 0.0;                           ///< of one coordinate of a pixel [px]
  std::optional<PlaneMeasurement> plane = {};
  bool is_used = true;
};

struct BodyPoseProblem {
  CameraModel camera;
  std::vector<SeenTag> tags;
};

/// A pose, and how it explains what was seen.
struct RefinedPose {
  Pose T_camera_body;
  double cost = 0.0;       ///< robust sum of squares in units of deviations, over the used tags
  double pixel_rms = 0.0;  ///< [px] of the used tags' corners, per corner
  Matrix6d information = Matrix6d::Zero();  ///< of [v; w] in body axes
};

/// Huber's loss of a residual of `size` deviations: its square up to 2, then linear.
[[nodiscard]] double huber(double size);

/// Root mean square distance of the corners of one tag from where the pose puts them [px];
/// infinite where it puts them behind the camera.
[[nodiscard]] double corner_rms(const BodyPoseProblem& problem, const SeenTag& tag,
                                const Pose& T_camera_body);

/// How badly the pose explains corners and depth of one tag: Huber's sum of squares.
[[nodiscard]] double tag_cost(const BodyPoseProblem& problem, const SeenTag& tag,
                              const Pose& T_camera_body);

/// Damped Gauss-Newton with Huber weights over the used tags, from `start`; nothing where it leaves
/// the part of space in front of the camera or is not determined.
[[nodiscard]] std::optional<RefinedPose> refine_body_pose(const BodyPoseProblem& problem,
                                                          const Pose& start);

}  // namespace pcavr
