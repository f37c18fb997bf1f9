// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/undistortion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pcavr/geometry/pixel.hpp"

namespace pcavr {
namespace {

/// tan(60 degrees). Margins up to 80 degrees, which the widest lenses see, would take eleven times
/// the pixels.
constexpr double kMaxSlope = 1.7321;

/// Whole pixels by which an ideal image must be longer on a side that a lens sees past by `slope`.
int margin(double slope, double focal_length, double to_border) {
  constexpr int kMaxSide = 16'384;  // [px] more than any sensor has
  return clamp_to_int(std::ceil(std::min(slope, kMaxSlope) * focal_length - to_border), 0,
                      kMaxSide);
}

CameraModel ideal_of(const CameraModel& camera) {
  CameraModel ideal = camera.undistorted();
  if (!camera.has_distortion()) return ideal;
  // The rays of the border tell how far to each side the lens sees.
  Eigen::AlignedBox2d view;
  for (int x = 0; x < camera.width; ++x) {
    view.extend(camera.normalise(Eigen::Vector2d(x, 0)));
    view.extend(camera.normalise(Eigen::Vector2d(x, camera.height - 1)));
  }
  for (int y = 0; y < camera.height; ++y) {
    view.extend(camera.normalise(Eigen::Vector2d(0, y)));
    view.extend(camera.normalise(Eigen::Vector2d(camera.width - 1, y)));
  }
  const int left = margin(-view.min().x(), camera.fx, camera.cx);
  const int top = margin(-view.min().y(), camera.fy, camera.cy);
  ideal.width += left + margin(view.max().x(), camera.fx, camera.width - 1 - camera.cx);
  ideal.height += top + margin(view.max().y(), camera.fy, camera.height - 1 - camera.cy);
  ideal.cx += left;
  ideal.cy += top;
  return ideal;
}

}  // namespace

void Undistortion::prepare(const CameraModel& camera) {
  if (camera_ && *camera_ == camera) return;
  camera_ = camera;
  source_.clear();
  ideal_ = ideal_of(camera);
  for (int v = 0; v < ideal_.height; ++v) {
    for (int u = 0; u < ideal_.width; ++u) {
      const Eigen::Vector2d pixel = camera.project(ideal_.unproject({u, v}, 1.0));
      const std::optional<int> x = pixel_index(pixel.x(), camera.width);
      const std::optional<int> y = pixel_index(pixel.y(), camera.height);
      source_.push_back(x && y ? *y * camera.width + *x : -1);
    }
  }
}

}  // namespace pcavr
