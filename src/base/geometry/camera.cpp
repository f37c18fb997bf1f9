// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/camera.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr {

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& p_camera) const {
  Eigen::Vector2d p(p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z());
  if (has_distortion()) p = distortion.distort(p);
  return {fx * p.x() + cx, fy * p.y() + cy};
}

Eigen::Matrix<double, 2, 3> CameraModel::projection_jacobian(
    const Eigen::Vector3d& p_camera) const {
  const double z = p_camera.z();
  const Eigen::Vector2d p = p_camera.head<2>() / z;
  Eigen::Matrix<double, 2, 3> perspective;
  perspective << 1.0 / z, 0.0, -p.x() / z, 0.0, 1.0 / z, -p.y() / z;
  Eigen::Matrix2d lens;
  (void)distortion.distort(p, &lens);
  return Eigen::Vector2d(fx, fy).asDiagonal() * lens * perspective;
}

Eigen::Vector2d CameraModel::normalise(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  return has_distortion() ? distortion.undistort(distorted) : distorted;
}

Eigen::Vector3d CameraModel::unproject(const Eigen::Vector2d& pixel, double z) const {
  const Eigen::Vector2d p = normalise(pixel);
  return {p.x() * z, p.y() * z, z};
}

bool CameraModel::contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 &&
         pixel.y() < height - 0.5;
}

CameraModel CameraModel::downsampled(int factor) const {
  PCAVR_REQUIRE(factor >= 1, factor);
  CameraModel binned = *this;
  binned.width = width / factor;
  binned.height = height / factor;
  binned.fx = fx / factor;
  binned.fy = fy / factor;
  // The centre of a square of pixels lies (factor - 1) / 2 from the centre of its first pixel.
  binned.cx = (cx - 0.5 * (factor - 1)) / factor;
  binned.cy = (cy - 0.5 * (factor - 1)) / factor;
  return binned;
}

CameraModel CameraModel::undistorted() const {
  CameraModel pinhole = *this;
  pinhole.distortion = {};
  return pinhole;
}

std::optional<LensFold> find_fold(const CameraModel& camera) {
  // Lens distortion is smooth: 64 steps across an image resolve it.
  constexpr int kSteps = 64;
  constexpr double kReprojectionTolerance =
      1e-9;  // on the plane z = 1: 1e-6 px at a focal length of 1000 px
  if (!camera.has_distortion()) return std::nullopt;
  const LensDistortion& lens = camera.distortion;
  const Eigen::Vector2d principal_point(camera.cx, camera.cy);
  std::optional<LensFold> fold;
  for (int j = 0; j <= kSteps; ++j) {
    for (int i = 0; i <= kSteps; ++i) {
      const Eigen::Vector2d pixel(camera.width * (i / double{kSteps}) - 0.5,
                                  camera.height * (j / double{kSteps}) - 0.5);
      const Eigen::Vector2d q((pixel.x() - camera.cx) / camera.fx,
                              (pixel.y() - camera.cy) / camera.fy);
      const Eigen::Vector2d p = lens.undistort(q);
      if (p.norm() <= lens.max_radius() && (lens.distort(p) - q).norm() < kReprojectionTolerance)
        continue;
      if (fold && (fold->pixel - principal_point).norm() <= (pixel - principal_point).norm()) {
        continue;
      }
      fold = {pixel, std::atan(lens.max_radius()), lens.folds()};
    }
  }
  return fold;
}

}  // namespace pcavr
