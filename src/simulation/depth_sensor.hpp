// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"

#include "simulation/renderer.hpp"

namespace pcavr::simulation {

/// A structured-light depth sensor such as the first Kinect: a pattern projector next to an
/// infrared camera, which measures the disparity between the two [Khoshelham & Elberink 2012].
struct DepthSensor {
  DepthNoise noise = {};         ///< axial, by range and incidence [Nguyen et al. 2012]
  double focal_length = 580.0;   ///< of the infrared camera [px]; determines the depth quantisation
  double baseline = 0.075;       ///< from the projector, on the left, to the camera [m]
  double disparity_steps = 8.0;  ///< per pixel
  double correlation = 0.75;     ///< of the noise: a Gaussian of this sigma [px]; down to 1/e at
                                 ///< 1.5 px, as neighbouring matching windows overlap
  double max_incidence = 75.0;   ///< [deg]; beyond, the pattern is not recognised
  double edge_depth_ratio = 0.03;      ///< an edge: depth step between neighbours over their depth
  double edge_loss_probability = 0.5;  ///< the matching window sees two surfaces
  double loss_probability = 4e-4;      ///< anywhere (dropout)
  double outlier_probability = 2e-4;   ///< wrong match: a uniform depth in the range

  /// Lateral noise: a pixel measures the surface some pixels away. Standard deviation [px] by
  /// incidence angle [rad] [Nguyen et al. 2012, eq. 1].
  [[nodiscard]] static double lateral_std(double incidence);
};

/// Simulates the measurement of a frame. The noise depends on `seed` and the pixel only. Lateral
/// noise: two Gaussian fields shift the pixel whose surface is seen; the depth is the intersection
/// of the pixel's own ray with that surface's plane, so that planar faces have axial noise only.
[[nodiscard]] DepthImage measure_depth(const DepthSensor& sensor, const CameraModel& camera,
                                       const IdealFrame& frame, std::uint64_t seed);

}  // namespace pcavr::simulation
