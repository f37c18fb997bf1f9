// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "draw_depth.hpp"

#include <algorithm>
#include <vector>

#include "pcavr/base/geometry/rasterise.hpp"

namespace pcavr {
namespace {

constexpr float kNearPlane = 0.05F;  ///< [m]

}  // namespace

DepthImage draw_depth(const TriangleMesh& mesh_base, const CameraModel& camera,
                      const Pose& T_camera_base) {
  // The views are drawn in parallel, each by one thread.
  const std::vector<ProjectedVertex> projected =
      project_vertices(mesh_base.vertices, camera, T_camera_base, kNearPlane, {1});
  DepthImage depth(camera.width, camera.height, 0.0F);  // inverse, while triangles are drawn
  const RasterWindow whole{0, 0, camera.width, camera.height};
  for (const auto& [i, j, k] : mesh_base.triangles) {
    const ProjectedVertex& a = projected[i];
    const ProjectedVertex& b = projected[j];
    const ProjectedVertex& c = projected[k];
    if (!(a.is_in_front() && b.is_in_front() && c.is_in_front())) continue;
    rasterise_triangle(
        a.pixel, b.pixel, c.pixel, whole, [&](int x, int y, float of_a, float of_b, float of_c) {
          float& nearest = depth(x, y);
          nearest = std::max(
              nearest, of_a * a.inverse_depth + of_b * b.inverse_depth + of_c * c.inverse_depth);
        });
  }
  for (float& value : depth.pixels()) value = value > 0.0F ? 1.0F / value : 0.0F;
  return depth;
}

}  // namespace pcavr
