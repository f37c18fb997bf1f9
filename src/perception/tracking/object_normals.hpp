// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr::tracking {

/// Smooth (Phong) normals of a CAD mesh with a crease angle of 30 degrees: interpolated across
/// edges below it, which tessellate a curved surface, and discontinuous at sharper ones. Facet
/// normals would make a sphere's rotation seem observable.
class SmoothNormals {
 public:
  explicit SmoothNormals(const TriangleMesh& mesh);

  /// Unit length.
  [[nodiscard]] Eigen::Vector3d at(const SurfaceQuery::Hit& hit) const;

 private:
  std::vector<std::array<Eigen::Vector3f, 3>> corners_;  ///< per triangle
};

}  // namespace pcavr::tracking
