// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/undistortion.hpp"

#include <cmath>

namespace pcavr {
namespace {

bool is_same(const CameraModel& a, const CameraModel& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy &&
         a.cx == b.cx && a.cy == b.cy && a.distortion == b.distortion;
}

}  // namespace

void Undistortion::prepare(const CameraModel& camera) {
  if (camera_ && is_same(*camera_, camera)) return;
  camera_ = camera;
  source_.clear();
  const CameraModel ideal = camera.undistorted();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d pixel = camera.project(ideal.unproject({u, v}, 1.0));
      const bool is_inside = camera.contains(pixel);
      const int x = is_inside ? static_cast<int>(std::lround(pixel.x())) : 0;
      const int y = is_inside ? static_cast<int>(std::lround(pixel.y())) : 0;
      const bool is_pixel = is_inside && x >= 0 && y >= 0 && x < camera.width && y < camera.height;
      source_.push_back(is_pixel ? y * camera.width + x : -1);
    }
  }
}

}  // namespace pcavr
