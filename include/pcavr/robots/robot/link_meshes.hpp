// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

/// The links' surfaces, each in its link's frame; open or closed.
struct LinkMeshes {
  std::vector<TriangleMesh> of_link;  ///< index as in RobotModel::links; empty: no surface
  std::vector<Error> warnings;        ///< one for each link that is drawn as rods
};

/// The surfaces from the visible shapes, or from the collision shapes where a link has no visible
/// ones. A link whose mesh files were not found becomes rods of 4 cm radius from its origin to the
/// joints that it carries. An Error for a mesh file that can't be read. Thread-safe.
[[nodiscard]] Expected<LinkMeshes> link_meshes(const RobotModel& model);

/// The link at the end of the longest chain of movable joints; of several, the last in the
/// description. Pure function.
[[nodiscard]] std::size_t default_tip(const RobotModel& model);

}  // namespace pcavr
