// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"

#include "simulation/renderer.hpp"

namespace pcavr::simulation {

/// A structured-light depth sensor as the first Kinect: a pattern projector beside an infrared
/// camera, which measures disparity between the two [Khoshelham & Elberink 2012].
struct DepthSensor {
  DepthNoise noise = {};         ///< axial, by range and incidence [Nguyen et al. 2012]
  double focal_length = 580.0;   ///< of the infrared camera [px]; sets the disparity's steps
  double baseline = 0.075;       ///< the projector stands this far to the camera's left [m]
  double disparity_steps = 8.0;  ///< in one pixel
  double correlation = 0.75;     ///< of the noise: a Gaussian of this sigma [px]; down to 1/e at
                                 ///< 1.5 px, as neighbouring matching windows overlap
  double grazing_limit = 75.0;   ///< [deg]; beyond, the pattern is not recognised
  double edge_jump = 0.03;       ///< neighbours this part of the range apart are an edge
  double lost_on_edges = 0.5;    ///< probability: the matching window sees two surfaces
  double lost_anywhere = 4e-4;   ///< probability
  double gross_errors = 2e-4;    ///< probability of a wrong match: any depth in range

  /// Lateral noise: the surface seen at a pixel is the one some pixels beside it. Sigma [px] by
  /// incidence [rad] [Nguyen et al. 2012, eq. 1].
  [[nodiscard]] static double lateral_sigma(double incidence);
};

/// Measures the frame. The noise depends on `seed` and the pixel only. Two gaussian fields for
/// lateral noise shift which surface is seen; the depth is where the pixel's own ray meets that
/// surface's plane, so that flat faces keep the axial noise alone.
[[nodiscard]] DepthImage measure_depth(const DepthSensor& sensor, const CameraModel& camera,
                                       const IdealFrame& frame, std::uint64_t seed);

}  // namespace pcavr::simulation
