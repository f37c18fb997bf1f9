// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/pixel.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// A vertex in an image, with its inverse depth, which is linear in the image.
struct ProjectedVertex {
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  float inverse_depth = 0.0F;  ///< [1/m]; 0: not in front of the camera
  [[nodiscard]] bool is_in_front() const { return inverse_depth > 0.0F; }
};

/// Projects each vertex. Those nearer than `near_plane` [m], or so far outside a distorted image
/// that a lens model may fold them back into it, are not in front.
[[nodiscard]] std::vector<ProjectedVertex> project_vertices(
    const std::vector<Eigen::Vector3f>& vertices_base, const CameraModel& camera,
    const Pose& T_camera_base, float near_plane, Parallelism parallelism);

/// The columns and rows [begin, end) of an image.
struct RasterWindow {
  int x_begin = 0;
  int y_begin = 0;
  int x_end = 0;
  int y_end = 0;
};

/// Twice the signed area in the image [px^2]: negative where the corners are counter-clockwise as
/// seen, since the image's y axis points down.
[[nodiscard]] inline float doubled_area(const Eigen::Vector2f& a, const Eigen::Vector2f& b,
                                        const Eigen::Vector2f& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Calls `set_pixel(x, y, of_a, of_b, of_c)` for the pixels of `window` whose centres are inside
/// the triangle, either way around, with the barycentric coordinates in the image; those of a
/// shared edge belong to both triangles. Edges are straight in the image, whatever the lens.
template <typename SetPixel>
void rasterise_triangle(const Eigen::Vector2f& a, const Eigen::Vector2f& b,
                        const Eigen::Vector2f& c, const RasterWindow& window,
                        const SetPixel& set_pixel) {
  const auto [x_min, x_max] = std::minmax({a.x(), b.x(), c.x()});
  const int x_first = clamp_to_int(std::ceil(x_min), window.x_begin, window.x_end);
  const int x_last = clamp_to_int(std::floor(x_max), window.x_begin - 1, window.x_end - 1);
  if (x_first > x_last) return;
  const auto [y_min, y_max] = std::minmax({a.y(), b.y(), c.y()});
  const int y_first = clamp_to_int(std::ceil(y_min), window.y_begin, window.y_end);
  const int y_last = clamp_to_int(std::floor(y_max), window.y_begin - 1, window.y_end - 1);
  if (y_first > y_last) return;
  const float area = doubled_area(a, b, c);
  if (area == 0.0F) return;
  for (int y = y_first; y <= y_last; ++y) {
    for (int x = x_first; x <= x_last; ++x) {
      const Eigen::Vector2f at(static_cast<float>(x), static_cast<float>(y));
      const float of_a = doubled_area(at, b, c) / area;
      const float of_b = doubled_area(at, c, a) / area;
      const float of_c = doubled_area(at, a, b) / area;
      if (of_a >= 0.0F && of_b >= 0.0F && of_c >= 0.0F) set_pixel(x, y, of_a, of_b, of_c);
    }
  }
}

}  // namespace pcavr
