// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/camera.hpp"
#include "pcavr/geometry/depth_noise.hpp"
#include "pcavr/geometry/image.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr::tracking {

/// One place on a body's outline, as expected and as the depth image shows it.
struct RimSight {
  Eigen::Vector3d p_object;     ///< the surface at the outline
  Eigen::Vector2d normal;       ///< of the outline in the image, unit, outward
  double outward_pixels = 0.0;  ///< by how much the outline is seen further out than expected
};

/// Where the depth image leaves the body's surface for something clearly behind it, or for nothing,
/// along lines across the expected outline [as RAPID does with intensity edges, Harris & Stennett
/// 1990]. Places where something covers the rim, or where the surface goes on (a box on its table),
/// show none. This holds a body that slides along the faces it shows, which depth on the faces
/// can't.
[[nodiscard]] std::vector<RimSight> find_rim(const SurfaceQuery& surface_object,
                                             const CameraModel& camera, const DepthImage& depth,
                                             const DepthNoise& noise, const Pose& T_camera_object);

}  // namespace pcavr::tracking
