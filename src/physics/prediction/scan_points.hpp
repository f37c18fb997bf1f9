// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/physics/prediction/closest_surface.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

namespace pcavr::detail {

/// The scan as points that one upright body cannot contain: vertices of the static mesh, and
/// samples of its triangles that are larger than kSpacing, at the body's height. Left out are the
/// support and its noise, and what the scan has of the body itself: points that lie deeper than
/// `max_scan_depth` inside it at the start, or face away from its surface closer than that.
/// Sorted in a grid of x and y; const after construction, no allocation in queries.
class ScanPoints {
 public:
  static constexpr double kSpacing =
      0.008;  ///< [m] between samples: edges of a scan of 5 mm are shorter

  ScanPoints() = default;
  /// `surface` in body axes (see UprightBody), `start` the body's initial state.
  ScanPoints(const ClosestSurface& surface, const PlanarState& start,
             const TriangleMesh& static_mesh_base, const WorldOptions& options);

  struct Point {
    Eigen::Vector3d p_base;
    Eigen::Vector3f normal_base;  ///< of the scanned surface, unit length
  };

  [[nodiscard]] bool is_empty() const noexcept { return points_.empty(); }

  /// Calls visit(point) for the points in a rectangle of x and y [m], in a fixed order.
  template <typename Visit>
  void visit_in(const Eigen::AlignedBox2d& area, const Visit& visit) const {
    if (points_.empty() || !area.intersects(bounds_)) return;
    const Eigen::Array2i low = cell_of(area.min());
    const Eigen::Array2i high = cell_of(area.max());
    for (int row = low.y(); row <= high.y(); ++row) {
      const std::size_t first = static_cast<std::size_t>(row) * columns_;
      const std::uint32_t end = starts_[first + static_cast<std::size_t>(high.x()) + 1];
      for (std::uint32_t i = starts_[first + static_cast<std::size_t>(low.x())]; i < end; ++i) {
        visit(points_[i]);
      }
    }
  }

 private:
  [[nodiscard]] Eigen::Array2i cell_of(const Eigen::Vector2d& p) const noexcept;
  void sort_into_cells();

  std::vector<Point> points_;
  std::vector<std::uint32_t> starts_;  ///< of each cell in points_, row by row, and the end
  Eigen::AlignedBox2d bounds_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  double cell_ = 0.01;  ///< [m]
};

}  // namespace pcavr::detail
