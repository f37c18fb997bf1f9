// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/mesh.hpp"
#include "pcavr/model/cad_model.hpp"

namespace pcavr::tracking {

/// Normals of the surface that a CAD mesh stands for: interpolated across edges that bend by less
/// than 30 degrees, which are facets of something round, and broken at sharper ones. Facets taken
/// at their word would make a ball's rotation seem visible.
class SmoothNormals {
 public:
  explicit SmoothNormals(const TriangleMesh& mesh);

  /// Unit length.
  [[nodiscard]] Eigen::Vector3d at(const SurfaceQuery::Hit& hit) const;

 private:
  std::vector<std::array<Eigen::Vector3f, 3>> corners_;  ///< per triangle
};

}  // namespace pcavr::tracking
