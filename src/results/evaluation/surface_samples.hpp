// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

struct SurfaceSample {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;  ///< of the triangle, unit, by winding
};

/// One sample for each `spacing`^2 of a mesh's area, evenly distributed: every sample represents
/// the same area, for any triangulation.
[[nodiscard]] std::vector<SurfaceSample> sample_surface(const TriangleMesh& mesh, double spacing,
                                                        std::uint64_t seed);

}  // namespace pcavr
