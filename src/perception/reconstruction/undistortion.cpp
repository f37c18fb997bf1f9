// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/undistortion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pcavr/base/geometry/pixel.hpp"

namespace pcavr {
namespace {

/// tan(60 degrees). Margins up to 80 degrees, as of the widest lenses, would need eleven times the
/// pixels.
constexpr double kMaxSlope = 1.7321;

/// Pixels by which the undistorted image must be extended on a side where the lens's field of view
/// ends at `slope`.
int margin(double slope, double focal_length, double to_border) {
  constexpr int kMaxSide = 16'384;  // [px], beyond any sensor
  return clamp_to_int(std::ceil(std::min(slope, kMaxSlope) * focal_length - to_border), 0,
                      kMaxSide);
}

CameraModel undistorted_of(const CameraModel& camera) {
  CameraModel undistorted = camera.undistorted();
  if (!camera.has_distortion()) return undistorted;
  // The border's rays give the field of view.
  Eigen::AlignedBox2d field_of_view;
  for (int x = 0; x < camera.width; ++x) {
    field_of_view.extend(camera.normalise(Eigen::Vector2d(x, 0)));
    field_of_view.extend(camera.normalise(Eigen::Vector2d(x, camera.height - 1)));
  }
  for (int y = 0; y < camera.height; ++y) {
    field_of_view.extend(camera.normalise(Eigen::Vector2d(0, y)));
    field_of_view.extend(camera.normalise(Eigen::Vector2d(camera.width - 1, y)));
  }
  const int left = margin(-field_of_view.min().x(), camera.fx, camera.cx);
  const int top = margin(-field_of_view.min().y(), camera.fy, camera.cy);
  undistorted.width +=
      left + margin(field_of_view.max().x(), camera.fx, camera.width - 1 - camera.cx);
  undistorted.height +=
      top + margin(field_of_view.max().y(), camera.fy, camera.height - 1 - camera.cy);
  undistorted.cx += left;
  undistorted.cy += top;
  return undistorted;
}

}  // namespace

void Undistortion::prepare(const CameraModel& camera) {
  if (camera_ && *camera_ == camera) return;
  camera_ = camera;
  source_.clear();
  undistorted_ = undistorted_of(camera);
  for (int v = 0; v < undistorted_.height; ++v) {
    for (int u = 0; u < undistorted_.width; ++u) {
      const Eigen::Vector2d pixel = camera.project(undistorted_.unproject({u, v}, 1.0));
      const std::optional<int> x = pixel_index(pixel.x(), camera.width);
      const std::optional<int> y = pixel_index(pixel.y(), camera.height);
      source_.push_back(x && y ? *y * camera.width + *x : -1);
    }
  }
}

}  // namespace pcavr
