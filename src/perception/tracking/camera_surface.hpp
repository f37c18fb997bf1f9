// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::tracking {

/// The image divided into square cells, some 160 across: the resolution of dense alignment.
struct CellGrid {
  int pixels = 1;                     ///< edge length of a cell [px]
  CameraModel camera;                 ///< downscaled: its pixels are the cells
  std::vector<Eigen::Vector2f> rays;  ///< through the cells' centres, on the plane z = 1
  /// Derivative of the lens distortion at each ray; empty without distortion.
  std::vector<Eigen::Matrix2f> lens_jacobians;

  explicit CellGrid(const CameraModel& full);

  [[nodiscard]] std::size_t size() const { return rays.size(); }
  [[nodiscard]] int width() const { return camera.width; }
  [[nodiscard]] int height() const { return camera.height; }
};

/// Transforms points into the camera frame of a grid and projects them to cells.
class CellProjector {
 public:
  /// Keeps a reference to the grid, which must outlive it.
  CellProjector(const CellGrid& grid, const Pose& T_camera_points);

  [[nodiscard]] const Eigen::Matrix3f& rotation() const { return R_; }
  [[nodiscard]] Eigen::Vector3f transform(const Eigen::Vector3f& p) const { return R_ * p + t_; }
  /// Projection in cells, with integers at their centres; z must be > 0.
  [[nodiscard]] Eigen::Vector2f cell(const Eigen::Vector3f& p_camera) const {
    if (has_distortion_) return grid_->camera.project(p_camera.cast<double>()).cast<float>();
    return focal_.cwiseProduct(p_camera.head<2>()) / p_camera.z() + centre_;
  }

 private:
  const CellGrid* grid_;
  Eigen::Matrix3f R_;
  Eigen::Vector3f t_;
  Eigen::Vector2f focal_;
  Eigen::Vector2f centre_;
  bool has_distortion_;
};

/// Inverse depth of each cell [1/m]; 0 where a cell contains an edge or a hole. The inverse depth
/// of a plane is linear in the image, so that averaging and interpolation are exact.
using InverseDepth = std::vector<float>;

/// Mean inverse depth of the cells without a hole or a depth step, and without a pixel of
/// `is_dynamic` (may be empty).
[[nodiscard]] InverseDepth cell_inverse_depth(const CellGrid& grid, const DepthImage& depth,
                                              const MaskImage& is_dynamic, const DepthNoise& noise);

/// A point and a unit normal for each cell, in camera axes; z = 0 if there is none.
struct Surface {
  std::vector<Eigen::Vector3f> points;   ///< [m]
  std::vector<Eigen::Vector3f> normals;  ///< zero where the surface is not smooth
};

/// Normals from a plane fit to 5x5 cells, or to 3x3 at edges.
[[nodiscard]] Surface make_surface(const CellGrid& grid, const InverseDepth& inverse_depth,
                                   const DepthNoise& noise);

/// Intersection of the ray through `pixel` of the full image with the surface [m, in camera axes];
/// nothing where the surface is not smooth.
[[nodiscard]] std::optional<Eigen::Vector3d> point_at(const CellGrid& grid, const Surface& surface,
                                                      const CameraModel& full,
                                                      const Eigen::Vector2d& pixel);

/// The keyframe's surface fused from all frames that matched it (the model of frame-to-model
/// tracking): a running average, which reduces noise.
struct SurfaceModel {
  InverseDepth inverse_depth;
  std::vector<float> weight;  ///< number of measurements in each cell
  int frames = 1;
};

/// Fuses a frame into the model. `surface` is the model's, from make_surface.
void fuse(const CellGrid& grid, const Surface& surface, const InverseDepth& frame,
          const Pose& T_model_frame, const DepthNoise& noise, SurfaceModel& model);

}  // namespace pcavr::tracking
