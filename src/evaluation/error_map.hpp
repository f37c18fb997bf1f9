// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/core/parallel.hpp"
#include "pcavr/geometry/mesh.hpp"
#include "pcavr/geometry/pose.hpp"

namespace pcavr {

/// A mesh coloured by its distance from the true surface, and a picture of it.
struct ErrorMap {
  TriangleMesh mesh_base;  ///< with normals; from dark violet, 0 mm, to yellow, 10 mm and beyond
  std::string jpeg;        ///< with a legend
};

/// Seen from where the cameras were, above and outside of the mesh. `T_base_camera` may be empty.
/// The same bytes for any Parallelism.
[[nodiscard]] ErrorMap error_map(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                                 const std::vector<Pose>& T_base_camera, Parallelism parallelism);

}  // namespace pcavr
