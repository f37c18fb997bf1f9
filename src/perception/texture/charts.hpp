// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// A part of the surface that is drawn in the atlas as seen along one direction.
struct Chart {
  Eigen::Vector3f normal_base = Eigen::Vector3f::UnitZ();
  Eigen::Matrix<float, 2, 3> axes_base;              ///< rows: the atlas's x and y, unit vectors
  Eigen::AlignedBox2f box;                           ///< of all levels' triangles, on the axes [m]
  float texel = 0.0F;                                ///< edge [m]
  Eigen::Vector2i corner = Eigen::Vector2i::Zero();  ///< in the atlas, of its padding [px]

  [[nodiscard]] Eigen::Vector2f on_axes(const Eigen::Vector3f& p_base) const {
    return axes_base * p_base;
  }
};

/// Charts that all levels of detail share.
struct ChartSet {
  std::vector<Chart> charts;
  /// Index into `charts`, by level, then by triangle.
  std::vector<std::vector<std::uint32_t>> chart_of_triangle;
};

/// Divides the surface of the last (coarsest) level into connected parts within a cone of normals
/// [as in Levy et al. 2002, sec. 3: region growing], each projected along its mean normal. A
/// triangle of a finer level belongs to the chart of the nearest coarse triangle: so every level
/// finds its colours at the same place of the atlas. Normals must be set.
[[nodiscard]] ChartSet make_charts(const std::vector<TriangleMesh>& levels_base,
                                   Parallelism parallelism);

}  // namespace pcavr
