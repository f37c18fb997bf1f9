// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// The virtual cameras at a sensor whose pixels sort the rays of its unorganised clouds: one camera
/// where the rays lie within 60 degrees of an axis, else the faces of a cube that hold points. All
/// have the same intrinsics; their angular resolution is the cloud's own, a point per pixel.
struct RangeCameras {
  CameraModel camera;
  std::vector<Pose> T_sensor_camera;  ///< rotations; one or up to six
  double ray_spacing = 0.0;           ///< median distance of neighbouring rays [rad]
  bool is_grid = false;               ///< the rays are the pixels of one depth camera
};

/// Chooses them from sample clouds in sensor coordinates (NaN: not measured). Empty cameras where
/// the clouds have less than 100 points together. Deterministic.
[[nodiscard]] RangeCameras choose_range_cameras(
    std::span<const std::vector<Eigen::Vector3f>> clouds_sensor);

/// Depth and colour of a cloud in one camera.
struct RangeImage {
  DepthImage depth;  ///< [m]; 0 where no ray passes
  ColorImage color;  ///< grey where the cloud has no colours
  std::size_t points_used = 0;
};

/// The range image of a cloud: of the points along the rays through a pixel the nearest are
/// averaged. A ray does not pass through the pixel's centre: inverse depth, which is linear in the
/// image on a plane, is moved there along the plane through the neighbouring points, so that
/// slanted surfaces are not biased. Pixels between points of one surface are filled likewise.
/// `colors` may be empty. Thread-safe, deterministic.
[[nodiscard]] RangeImage render_range_image(const std::vector<Eigen::Vector3f>& points_sensor,
                                            const std::vector<Rgb8>& colors,
                                            const CameraModel& camera, const Pose& T_sensor_camera);

}  // namespace pcavr
