// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "draw_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace pcavr {
namespace {

constexpr float kNear = 0.05F;  ///< [m]
/// Of the squared slope of the image's farthest corner: beyond, a lens model may fold points back
/// into the image.
constexpr double kMaxSlopeFactor = 1.5;

/// Pixel, and inverse depth [1/m], which is linear in the image; 0: not in front of the camera.
using Projected = Eigen::Vector3f;

double max_squared_slope(const CameraModel& camera) {
  if (!camera.has_distortion()) return std::numeric_limits<double>::infinity();
  double slope = 0.0;
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0})
      slope = std::max(slope, camera.unproject({x, y}, 1.0).head<2>().squaredNorm());
  }
  return kMaxSlopeFactor * slope;
}

std::vector<Projected> project_vertices(const TriangleMesh& mesh_base, const CameraModel& camera,
                                        const Pose& T_camera_base) {
  const Eigen::Matrix3f R = T_camera_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_camera_base.translation().cast<float>();
  const Eigen::Vector2f focal(static_cast<float>(camera.fx), static_cast<float>(camera.fy));
  const Eigen::Vector2f center(static_cast<float>(camera.cx), static_cast<float>(camera.cy));
  const double max_slope = max_squared_slope(camera);
  std::vector<Projected> projected(mesh_base.vertices.size(), Projected::Zero());
  for (std::size_t i = 0; i < projected.size(); ++i) {
    const Eigen::Vector3f p = R * mesh_base.vertices[i] + t;
    if (!(p.z() > kNear)) continue;
    const Eigen::Vector2f slope = p.head<2>() / p.z();
    if (camera.has_distortion()) {
      if (static_cast<double>(slope.squaredNorm()) > max_slope) continue;
      projected[i].head<2>() = camera.project(p.cast<double>().eval()).cast<float>();
    } else {
      projected[i].head<2>() = focal.cwiseProduct(slope) + center;
    }
    projected[i].z() = 1.0F / p.z();
  }
  return projected;
}

float cross(const Projected& origin, const Projected& a, const Projected& b) {
  return (a.x() - origin.x()) * (b.y() - origin.y()) - (a.y() - origin.y()) * (b.x() - origin.x());
}

/// The pixel indices within [low, high], of `size`; empty where the first is larger than the last.
std::array<int, 2> pixels_between(float low, float high, int size) {
  const auto last = static_cast<float>(size - 1);
  return {static_cast<int>(std::ceil(std::clamp(low, 0.0F, last + 1.0F))),
          static_cast<int>(std::floor(std::clamp(high, -1.0F, last)))};
}

void draw_triangle(const Projected& a, const Projected& b, const Projected& c,
                   Image<float>& inverse_depth) {
  const auto [x_min, x_max] = std::minmax({a.x(), b.x(), c.x()});
  const auto [x_first, x_last] = pixels_between(x_min, x_max, inverse_depth.width());
  if (x_first > x_last) return;
  const auto [y_min, y_max] = std::minmax({a.y(), b.y(), c.y()});
  const auto [y_first, y_last] = pixels_between(y_min, y_max, inverse_depth.height());
  if (y_first > y_last) return;
  const float area = cross(a, b, c);
  if (area == 0.0F) return;
  for (int y = y_first; y <= y_last; ++y) {
    for (int x = x_first; x <= x_last; ++x) {
      const Projected at(static_cast<float>(x), static_cast<float>(y), 0.0F);
      const float of_a = cross(at, b, c) / area;
      const float of_b = cross(at, c, a) / area;
      const float of_c = cross(at, a, b) / area;
      if (!(of_a >= 0.0F && of_b >= 0.0F && of_c >= 0.0F)) continue;
      float& nearest = inverse_depth(x, y);
      nearest = std::max(nearest, of_a * a.z() + of_b * b.z() + of_c * c.z());
    }
  }
}

}  // namespace

DepthImage draw_depth(const TriangleMesh& mesh_base, const CameraModel& camera,
                      const Pose& T_camera_base) {
  const std::vector<Projected> projected = project_vertices(mesh_base, camera, T_camera_base);
  DepthImage depth(camera.width, camera.height, 0.0F);  // inverse, while triangles are drawn
  for (const auto& [i, j, k] : mesh_base.triangles) {
    const Projected& a = projected[i];
    const Projected& b = projected[j];
    const Projected& c = projected[k];
    if (a.z() > 0.0F && b.z() > 0.0F && c.z() > 0.0F) draw_triangle(a, b, c, depth);
  }
  for (float& value : depth.pixels()) value = value > 0.0F ? 1.0F / value : 0.0F;
  return depth;
}

}  // namespace pcavr
