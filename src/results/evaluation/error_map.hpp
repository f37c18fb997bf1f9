// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// A mesh coloured by its distance from the true surface, and a picture of it.
struct ErrorMap {
  TriangleMesh mesh_base;  ///< with normals; from dark violet, 0, to yellow, max_error and beyond
  double max_error = 0.0;  ///< [m]: 1, 2, 5, 10 or 20 mm
  std::string jpeg;        ///< with a legend
};

/// Seen from where the cameras were, above and outside of the mesh. `T_base_camera` may be empty.
/// `error_p95` [m]: their 95th percentile, which the scale exceeds. The same bytes for any
/// Parallelism.
[[nodiscard]] ErrorMap error_map(const TriangleMesh& truth_base, const TriangleMesh& mesh_base,
                                 const std::vector<Pose>& T_base_camera, double error_p95,
                                 Parallelism parallelism);

}  // namespace pcavr
