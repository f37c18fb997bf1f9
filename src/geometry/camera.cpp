// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/geometry/camera.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

/// Distorted coordinates on z = 1 and, where asked for, their derivative.
Eigen::Vector2d distort(const std::array<double, 5>& d, const Eigen::Vector2d& p,
                        Eigen::Matrix2d* jacobian = nullptr) {
  const auto [k1, k2, p1, p2, k3] = d;
  const double x = p.x();
  const double y = p.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  if (jacobian != nullptr) {
    const double slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));  // 2 d(radial)/d(r2)
    (*jacobian) << radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
        x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,  //
        x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
        radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  }
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

}  // namespace

bool CameraModel::has_distortion() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0.0; });
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& p_camera) const {
  Eigen::Vector2d p(p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z());
  if (has_distortion()) p = distort(distortion, p);
  return {fx * p.x() + cx, fy * p.y() + cy};
}

Eigen::Vector2d CameraModel::normalise(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (!has_distortion()) return target;
  Eigen::Vector2d p = target;
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix2d jacobian;
    const Eigen::Vector2d residual = distort(distortion, p, &jacobian) - target;
    p -= jacobian.inverse() * residual;
    if (residual.squaredNorm() < 1e-24) break;
  }
  return p;
}

Eigen::Vector3d CameraModel::unproject(const Eigen::Vector2d& pixel, double z) const {
  const Eigen::Vector2d p = normalise(pixel);
  return {p.x() * z, p.y() * z, z};
}

bool CameraModel::contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 &&
         pixel.y() < height - 0.5;
}

CameraModel CameraModel::shrunk(int factor) const {
  PCAVR_REQUIRE(factor >= 1, factor);
  CameraModel small = *this;
  small.width = width / factor;
  small.height = height / factor;
  small.fx = fx / factor;
  small.fy = fy / factor;
  // The centre of a square of pixels lies (factor - 1) / 2 from the centre of its first pixel.
  small.cx = (cx - 0.5 * (factor - 1)) / factor;
  small.cy = (cy - 0.5 * (factor - 1)) / factor;
  return small;
}

CameraModel CameraModel::undistorted() const {
  CameraModel ideal = *this;
  ideal.distortion = {};
  return ideal;
}

}  // namespace pcavr
