// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pcavr/base/geometry/lens.hpp"

namespace pcavr {

/// A pinhole camera with a lens, as OpenCV and ROS define them.
/// Camera axes: x right, y down, z forward. The centre of pixel (0, 0) is at u = 0, v = 0.
struct CameraModel {
  int width = 0;    ///< [px]
  int height = 0;   ///< [px]
  double fx = 0.0;  ///< focal length [px]
  double fy = 0.0;
  double cx = 0.0;  ///< principal point [px]
  double cy = 0.0;
  LensDistortion distortion = {};

  [[nodiscard]] bool has_distortion() const { return !distortion.is_none(); }

  /// Pixel of a point in camera coordinates; z must be > 0.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const;

  /// d(pixel)/d(p_camera); z must be > 0.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> projection_jacobian(
      const Eigen::Vector3d& p_camera) const;

  /// Normalized image coordinates: the undistorted point on the plane z = 1, to 1e-12.
  [[nodiscard]] Eigen::Vector2d normalise(const Eigen::Vector2d& pixel) const;

  /// Point in camera coordinates at depth z [m] along the optical axis.
  [[nodiscard]] Eigen::Vector3d unproject(const Eigen::Vector2d& pixel, double z) const;

  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const;

  /// The camera of the image downsampled (binned) by an integer factor.
  [[nodiscard]] CameraModel downsampled(int factor) const;

  /// This camera without its distortion: the model of an undistorted image.
  [[nodiscard]] CameraModel undistorted() const;

  friend bool operator==(const CameraModel&, const CameraModel&) = default;
};

/// A place within an image at which a lens model is not invertible (not monotonic).
struct LensFold {
  Eigen::Vector2d pixel;   ///< the non-invertible pixel nearest to the principal point
  double max_angle = 0.0;  ///< from the optical axis, up to which the lens is invertible [rad]
  bool is_fold = true;     ///< false: the model is invertible, but the ray is beyond 85 degrees
};

/// Searches a grid over the whole image, corners and borders included: the ray of each pixel must
/// lie within the lens's max_radius() and project back to the pixel.
[[nodiscard]] std::optional<LensFold> find_fold(const CameraModel& camera);

}  // namespace pcavr
