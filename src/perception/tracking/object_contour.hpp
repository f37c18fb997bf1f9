// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr::tracking {

/// A point of a body's predicted occluding contour, matched to a depth edge.
struct ContourMatch {
  Eigen::Vector3d p_object;     ///< surface point on the contour
  Eigen::Vector2d normal;       ///< of the contour in the image, unit, outward
  double outward_pixels = 0.0;  ///< observed minus predicted position along `normal` [px]
};

/// Matches the predicted occluding contour (silhouette) to depth edges along scan lines across it,
/// like RAPID [Harris & Stennett 1990] with intensity edges. A depth edge is where readings change
/// from the body's surface to the background or to no depth. There is no match where an occluder
/// covers the contour or the surface continues (a box on its table). The matches constrain sliding
/// along the visible faces, which depth on the faces does not observe.
[[nodiscard]] std::vector<ContourMatch> match_contour(const SurfaceQuery& surface_object,
                                                      const CameraModel& camera,
                                                      const DepthImage& depth,
                                                      const DepthNoise& noise,
                                                      const Pose& T_camera_object);

}  // namespace pcavr::tracking
