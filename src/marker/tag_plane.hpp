// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// A plane m . p = 1 in camera coordinates, as depth saw it. In these terms it is linear in what
/// is measured: the inverse depth at (x, y) on z = 1 is m . (x, y, 1).
struct PlaneMeasurement {
  Eigen::Vector3d m = Eigen::Vector3d::Zero();                 ///< [1/m]
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Zero();  ///< of m: whitens it
};

/// The plane through the depth inside four corners of a tag [px]; nothing where too little of it
/// was measured. `share` (1 or more) is the number of tags seen by the same sensor: its systematic
/// error, taken to be as large as its noise, is not averaged away by looking at more of them.
[[nodiscard]] std::optional<PlaneMeasurement> measure_tag_plane(
    const DepthImage& depth, const DepthNoise& noise, const CameraModel& camera,
    const std::array<Eigen::Vector2d, 4>& corners, int share);

}  // namespace pcavr
