// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/base/geometry/pixel.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

/// Lens distortion bends the edges of the box beyond the rectangle of its corners: by less than
/// this share of the rectangle with the plumb-bob model. Other models bend more: there, this many
/// points of each edge are projected, between which the margin suffices.
constexpr double kDistortionMargin = 0.1;
constexpr int kEdgePoints = 9;

constexpr std::size_t kRowsPerTask = 8;  // amortises the scheduling of a task

/// Extends `pixels` by the projections of points along the twelve edges of a box.
void extend_by_edges(const Eigen::AlignedBox3f& box_mesh, const CameraModel& camera,
                     const Pose& T_camera_mesh, Eigen::AlignedBox2d& pixels) {
  for (int edge = 0; edge < 12; ++edge) {
    // Four parallel edges along each axis, on different sides of the other two axes.
    const int axis = edge / 4;
    const Eigen::Vector3d low = box_mesh.min().cast<double>();
    const Eigen::Vector3d size = box_mesh.sizes().cast<double>();
    Eigen::Vector3d share;
    share[(axis + 1) % 3] = edge % 2;
    share[(axis + 2) % 3] = edge / 2 % 2;
    for (int i = 0; i < kEdgePoints; ++i) {
      share[axis] = i / (kEdgePoints - 1.0);
      pixels.extend(camera.project(T_camera_mesh * (low + size.cwiseProduct(share)).eval()));
    }
  }
}

}  // namespace

PixelRectangle visible_rectangle(const Eigen::AlignedBox3f& bounds_mesh, const CameraModel& camera,
                                 const Pose& T_mesh_camera) {
  if (bounds_mesh.isEmpty()) return {};
  const PixelRectangle whole{0, 0, camera.width, camera.height};
  const Pose T_camera_mesh = T_mesh_camera.inverse();
  Eigen::AlignedBox2d pixels;
  bool is_in_front = false;
  bool is_behind = false;
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3f::CornerType>(i);
    const Eigen::Vector3d p_camera =
        T_camera_mesh * bounds_mesh.corner(corner).cast<double>().eval();
    if (p_camera.z() > 1e-6) {
      is_in_front = true;
      pixels.extend(camera.project(p_camera));
    } else {
      is_behind = true;
    }
  }
  if (!is_in_front) return {};
  if (is_behind) return whole;

  if (camera.distortion.model() != LensModel::plumb_bob) {
    extend_by_edges(bounds_mesh, camera, T_camera_mesh, pixels);
  }
  Eigen::Vector2d margin(1.0, 1.0);
  if (camera.has_distortion()) margin += kDistortionMargin * pixels.sizes();
  const Eigen::Vector2d low = (pixels.min() - margin).array().floor();
  const Eigen::Vector2d high = (pixels.max() + margin).array().ceil() + 1.0;
  return {clamp_to_int(low.x(), 0, camera.width), clamp_to_int(low.y(), 0, camera.height),
          clamp_to_int(high.x(), 0, camera.width), clamp_to_int(high.y(), 0, camera.height)};
}

DepthImage render_depth(const SurfaceQuery& surface, const CameraModel& camera,
                        const Pose& T_mesh_camera, Parallelism parallelism) {
  DepthImage depth(camera.width, camera.height, 0.0F);
  const PixelRectangle rectangle = visible_rectangle(surface.bounds(), camera, T_mesh_camera);
  if (rectangle.empty()) return depth;
  const Eigen::Matrix3d R_mesh_camera = T_mesh_camera.rotation_matrix();
  const Eigen::Vector3f origin = T_mesh_camera.translation().cast<float>();
  const auto rows = static_cast<std::size_t>(rectangle.y_end - rectangle.y_begin);
  parallel_for(parallelism, rows, kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int y = rectangle.y_begin + static_cast<int>(row);
      for (int x = rectangle.x_begin; x < rectangle.x_end; ++x) {
        const Eigen::Vector3d ray_camera = camera.unproject({x, y}, 1.0);
        const auto hit = surface.cast(origin, (R_mesh_camera * ray_camera).cast<float>());
        if (hit) depth(x, y) = hit->distance / static_cast<float>(ray_camera.norm());
      }
    }
  });
  return depth;
}

}  // namespace pcavr
