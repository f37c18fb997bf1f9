// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/perception/texture/mesh_texture.hpp"

namespace pcavr {

/// A plane that supports movable bodies, within a convex outline (counter-clockwise from above).
struct SupportArea {
  Plane plane_base;
  std::vector<Eigen::Vector3d> outline_base;
};

/// The parts of support planes that no view saw because something dynamic (a movable body or the
/// tool) was in front of them: a mesh in squares of `cell` [m], with colours that continue those
/// around (see fill_gaps.hpp). A square is left out where the static mesh is, where a view measured
/// something behind it, and where no dynamic pixel ever hid it: what was never in view, or hidden
/// by static things only, is not invented.
[[nodiscard]] TriangleMesh find_unseen_support(const std::vector<SupportArea>& areas,
                                               const TriangleMesh& static_mesh_base,
                                               const std::vector<TextureView>& views,
                                               const CameraModel& color_camera, double cell);

}  // namespace pcavr
