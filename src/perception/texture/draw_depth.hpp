// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// The depth image [m] of an ideal camera, 0 where there is no surface, by rasterisation: where
/// triangles are about as large as pixels, several times faster than by ray casting, which needs a
/// hierarchy of them first (render_depth in model). Edges are straight in the image, whatever the
/// lens. Triangles that reach nearer than 5 cm are left out.
[[nodiscard]] DepthImage draw_depth(const TriangleMesh& mesh_base, const CameraModel& camera,
                                    const Pose& T_camera_base);

}  // namespace pcavr
