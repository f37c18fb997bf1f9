// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/marker/body_pose.hpp"

namespace pcavr {

/// A plane m . p = 1 in camera coordinates, measured by depth. In this parametrisation it is linear
/// in the measurement: the inverse depth at (x, y) on z = 1 is m . (x, y, 1).
struct PlaneMeasurement {
  Eigen::Vector3d m = Eigen::Vector3d::Zero();                 ///< [1/m]
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Zero();  ///< of m (whitening matrix)
};

/// Fits a plane to the depth inside the four corners of a tag [px]; nothing if there is too little
/// depth. `tag_count` (1 or more) is the number of tags in the same image: the sensor's systematic
/// error, assumed as large as its noise, is not reduced by averaging over them.
[[nodiscard]] std::optional<PlaneMeasurement> measure_tag_plane(
    const DepthImage& depth, const DepthNoise& noise, const CameraModel& camera,
    const std::array<Eigen::Vector2d, 4>& corners, int tag_count, const BodyPoseOptions& options);

}  // namespace pcavr
