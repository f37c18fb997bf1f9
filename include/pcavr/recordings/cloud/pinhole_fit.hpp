// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"

namespace pcavr {

/// Axes in which clouds are stored, relative to the camera frame: the camera's own (x right, y
/// down, z forward), a robot's (x forward, y left, z up) and a graphics library's (x right, y up, z
/// backward). Rotations T_sensor_camera.
enum class SensorAxes { optical, robot, graphics };
[[nodiscard]] Pose sensor_camera_pose(SensorAxes axes);

/// A camera fitted to an organised cloud.
struct PinholeFit {
  CameraModel camera;
  Pose T_sensor_camera;  ///< a rotation
  /// Distances between the points' projections and their pixels, both axes [px].
  double residual_rms = 0.0;
  double residual_max = 0.0;
  bool is_mirrored = false;  ///< only a mirrored image fits: the axes are left-handed
};

/// The rms residual up to which an organised cloud is a pinhole projection [px]: rounding of
/// coordinates to millimetres gives 0.3, a lens that is not rectified several.
inline constexpr double kMaxPinholeResidual = 0.5;

/// Estimates fx, fy, cx, cy by least squares of pixel against x / z and y / z, which is exact for a
/// cloud made from a rectified depth image. Of the SensorAxes those with the least residual are
/// taken. `points` are in sensor coordinates, row by row. nullopt with less than 100 points, or
/// where none lie in front of the sensor. Deterministic; O(points).
[[nodiscard]] std::optional<PinholeFit> fit_pinhole(int width, int height,
                                                    const std::vector<Eigen::Vector3f>& points);

/// The rms distance between pixels and projections of an organised cloud's points [px]; 0 without
/// points in front of the camera.
[[nodiscard]] double projection_residual(const PinholeFit& fit,
                                         const std::vector<Eigen::Vector3f>& points);

}  // namespace pcavr
