// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace pcavr {

/// A pinhole camera with plumb-bob lens distortion [Brown 1966], as OpenCV and ROS define it.
/// Camera axes: x right, y down, z forward. The centre of pixel (0, 0) is at u = 0, v = 0.
struct CameraModel {
  int width = 0;    ///< [px]
  int height = 0;   ///< [px]
  double fx = 0.0;  ///< focal length [px]
  double fy = 0.0;
  double cx = 0.0;  ///< principal point [px]
  double cy = 0.0;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3

  [[nodiscard]] bool has_distortion() const;

  /// Pixel of a point in camera coordinates; z must be > 0.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const;

  /// Where a distorted pixel would lie without distortion, on the plane z = 1. Solved by Newton's
  /// method to 1e-12 where the model is invertible.
  [[nodiscard]] Eigen::Vector2d normalise(const Eigen::Vector2d& pixel) const;

  /// Point in camera coordinates at depth z [m] along the optical axis.
  [[nodiscard]] Eigen::Vector3d unproject(const Eigen::Vector2d& pixel, double z) const;

  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const;

  /// The camera of the image shrunk by an integer factor, pixels averaged in squares.
  [[nodiscard]] CameraModel shrunk(int factor) const;

  /// This camera without its distortion: the model of an undistorted image.
  [[nodiscard]] CameraModel undistorted() const;
};

}  // namespace pcavr
