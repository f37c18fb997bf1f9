// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/rasterise.hpp"

#include <cstddef>
#include <limits>

namespace pcavr {
namespace {

/// Largest squared slope of a point, as a multiple of that of the image's farthest corner: beyond,
/// a lens model may fold points back into the image.
constexpr double kMaxSlopeFactor = 1.5;
constexpr std::size_t kVerticesPerChunk = 1 << 16;  // amortises the scheduling of a task

double max_squared_slope(const CameraModel& camera) {
  if (!camera.has_distortion()) return std::numeric_limits<double>::infinity();
  double slope = 0.0;
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0})
      slope = std::max(slope, camera.unproject({x, y}, 1.0).head<2>().squaredNorm());
  }
  return kMaxSlopeFactor * slope;
}

}  // namespace

std::vector<ProjectedVertex> project_vertices(const std::vector<Eigen::Vector3f>& vertices_base,
                                              const CameraModel& camera, const Pose& T_camera_base,
                                              float near_plane, Parallelism parallelism) {
  const Eigen::Matrix3f R = T_camera_base.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_camera_base.translation().cast<float>();
  const Eigen::Vector2f focal(static_cast<float>(camera.fx), static_cast<float>(camera.fy));
  const Eigen::Vector2f center(static_cast<float>(camera.cx), static_cast<float>(camera.cy));
  const double max_slope = max_squared_slope(camera);
  std::vector<ProjectedVertex> projected(vertices_base.size());
  parallel_for(parallelism, projected.size(), kVerticesPerChunk,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   const Eigen::Vector3f p_camera = R * vertices_base[i] + t;
                   if (!(p_camera.z() > near_plane)) continue;
                   const Eigen::Vector2f slope = p_camera.head<2>() / p_camera.z();
                   if (static_cast<double>(slope.squaredNorm()) > max_slope) continue;
                   projected[i].pixel =
                       camera.has_distortion()
                           ? camera.project(p_camera.cast<double>().eval()).cast<float>().eval()
                           : Eigen::Vector2f(focal.cwiseProduct(slope) + center);
                   projected[i].inverse_depth = 1.0F / p_camera.z();
                 }
               });
  return projected;
}

}  // namespace pcavr
