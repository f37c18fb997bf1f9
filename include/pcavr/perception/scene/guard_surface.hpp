// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// A virtual surface that protects equipment [paper A]: the tool feels it and never passes it;
/// objects do. Frame: base.
struct GuardBox {
  Pose T_base_box;                                 ///< of its centre
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< [m]
};
/// A square sheet; the tool must stay on the side that the normal points to.
struct GuardPlane {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [m] its centre
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double size = 2.0;  ///< [m] its edge
};
/// The scan, grown by a margin: all points this near to an occupied cell of the map.
struct GuardScan {
  double margin = 0.0;  ///< [m]
};
struct GuardSurface {
  std::string name;
  std::variant<GuardBox, GuardPlane, GuardScan> shape;
};

/// Its triangles. A scan's are made from the scene's occupancy map (`occupancy.bt`): the surface at
/// the margin's distance from its occupied cells, to half a cell. Errors: the map can't be read,
/// has no occupied cells, or is too large for that margin.
[[nodiscard]] Expected<TriangleMesh> guard_mesh(const GuardSurface& guard,
                                                const std::filesystem::path& scene_folder);

/// Whether a sphere around `p_base` touches what the guard protects: the box, the grown scan, or
/// the space behind the plane. `radius` [m]. Errors as above.
[[nodiscard]] Expected<bool> is_guarded(const GuardSurface& guard,
                                        const std::filesystem::path& scene_folder,
                                        const Eigen::Vector3d& p_base, double radius);

}  // namespace pcavr
