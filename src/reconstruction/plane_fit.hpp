// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"

namespace pcavr {

/// The surface around a pixel (u0, v0): 1 / z = inverse_depth + slope_u (u - u0) + slope_v (v - v0).
struct InversePlane {
  float inverse_depth = 0.0F;  ///< [1/m]
  float slope_u = 0.0F;        ///< [1/m a pixel]
  float slope_v = 0.0F;
};

/// Least-squares planes through the inverse depth in a window around each pixel, of the pixels
/// that belong to the same surface. Inverse depth is where stereo and structured light have even
/// noise and even steps.
class InversePlaneFitter {
 public:
  InversePlaneFitter(const DepthImage& depth, const DepthNoise& noise, const CameraModel& camera);
  /// Planes of row v; `planes` has the image's width. Pixels without depth are left as they are.
  void fit_row(int v, std::span<InversePlane> planes) const;

 private:
  int width_;
  int stride_;
  std::vector<float> inverse_;    ///< padded by kReach on every side; 0: nothing
  std::vector<float> tolerance_;  ///< same layout: largest difference on one surface
};

}  // namespace pcavr
