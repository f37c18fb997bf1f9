// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr::detail {

/// Heights of the scan below the supports: the highest level surface in each cell of 2 cm of x and
/// y, where a body that falls comes to rest. Const after construction.
class FloorHeights {
 public:
  /// Surfaces less than `height_tolerance` [m] below the lowest of the `supports_base` are none.
  FloorHeights(const TriangleMesh& static_mesh_base,
               const std::vector<std::vector<Eigen::Vector3d>>& supports_base,
               double height_tolerance);

  /// The height in base [m] below a point of an edge at height `from` [m]; empty where the scan
  /// shows nothing.
  [[nodiscard]] std::optional<double> below(const Eigen::Vector2d& p_base,
                                            double from) const noexcept;

 private:
  [[nodiscard]] std::optional<std::size_t> cell_of(const Eigen::Vector2d& p) const noexcept;

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  Eigen::Array2d cells_ = Eigen::Array2d::Zero();  ///< along x and y
  double cell_ = 0.02;                             ///< [m]
  std::vector<std::optional<float>> heights_;
};

}  // namespace pcavr::detail
