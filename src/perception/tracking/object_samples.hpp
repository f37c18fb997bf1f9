// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"

#include "perception/tracking/object_normals.hpp"

namespace pcavr::tracking {

/// One pixel whose ray hits the body, away from its contour.
struct SurfaceSample {
  Eigen::Vector3d p_object;       ///< where the ray hits the surface
  Eigen::Vector3d normal_object;  ///< unit, toward the camera
  Eigen::Vector3d ray_object;     ///< the pixel's ray, scaled to a depth of 1 m
  double expected_depth = 0.0;    ///< [m]
  double measured_depth = 0.0;    ///< [m], > 0
};

/// A grid of about `max_samples` pixels (a few more at its ends) over the part of the image in
/// which a body is expected. The grid is fixed; the rays are cast again at every iteration. Keeps
/// references.
class SampleGrid {
 public:
  SampleGrid(const SurfaceQuery& surface_object, const SmoothNormals& normals_object,
             const CameraModel& camera, const DepthImage& depth, const Pose& T_camera_object,
             int max_samples);

  /// Rays that hit the body and whose neighbours in the grid hit it too, so that no sample lies on
  /// the contour, where a pixel mixes the body with the background.
  [[nodiscard]] std::vector<SurfaceSample> samples(const Pose& T_camera_object) const;

  [[nodiscard]] int stride() const { return stride_; }

 private:
  struct Cell {
    Eigen::Vector3d ray_camera;
    double measured_depth = 0.0;
  };
  const SurfaceQuery& surface_;
  const SmoothNormals& normals_;
  int stride_ = 1;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace pcavr::tracking
