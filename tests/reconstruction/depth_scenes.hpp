// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <optional>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::test {

inline CameraModel small_camera() {
  CameraModel camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 130.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

/// Distance along a ray (origin, direction) to a surface, if it is hit.
using Surface =
    std::function<std::optional<double>(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

inline Surface plane(const Eigen::Vector3d& normal, double offset) {
  return [=](const Eigen::Vector3d& from, const Eigen::Vector3d& ray) -> std::optional<double> {
    const double t = (offset - normal.dot(from)) / normal.dot(ray);
    if (!(t > 0.0)) return std::nullopt;
    return t;
  };
}

inline Surface sphere(const Eigen::Vector3d& centre, double radius) {
  return [=](const Eigen::Vector3d& from, const Eigen::Vector3d& ray) -> std::optional<double> {
    const Eigen::Vector3d d = from - centre;
    const double a = ray.squaredNorm();
    const double b = d.dot(ray);
    const double root = b * b - a * (d.squaredNorm() - radius * radius);
    if (root < 0.0) return std::nullopt;
    const double t = (-b - std::sqrt(root)) / a;
    if (!(t > 0.0)) return std::nullopt;
    return t;
  };
}

inline Surface nearest_of(const Surface& a, const Surface& b) {
  return [=](const Eigen::Vector3d& from, const Eigen::Vector3d& ray) -> std::optional<double> {
    const auto ta = a(from, ray);
    const auto tb = b(from, ray);
    if (!ta) return tb;
    if (!tb) return ta;
    return std::min(*ta, *tb);
  };
}

/// The depth image of a noise-free camera.
inline DepthImage depth_of(const Surface& surface, const CameraModel& camera,
                           const Pose& T_base_camera) {
  DepthImage depth(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      // A ray with z = 1 in camera axes: its length is the depth.
      const Eigen::Vector3d ray_camera = camera.unproject({u, v}, 1.0);
      const auto t = surface(T_base_camera.translation(), T_base_camera.rotation() * ray_camera);
      if (t) depth(u, v) = static_cast<float>(*t);
    }
  }
  return depth;
}

/// The pose of a camera at `eye` that looks at `target`.
inline Pose looking_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d side =
      std::abs(z.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d x = z.cross(side).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {Eigen::Quaterniond(R), eye};
}

}  // namespace pcavr::test
