// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/close_vertices.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "base/model/mesh_repair.hpp"

namespace pcavr::model {
namespace {

/// Finds the nearest of the points added before within a tolerance. Points are in the cells of a
/// grid as large as the tolerance, and searched in a cell and its neighbours, so the place of the
/// borders does not matter. Points that are kept are farther apart than the tolerance: few fit into
/// a cell, and time is linear in the points.
class PointsApart {
 public:
  PointsApart(const std::vector<Eigen::Vector3f>& points, double tolerance)
      : points_(points), tolerance_(tolerance) {}

  /// The index of the nearest point that was kept, the first of equally near ones; the point itself
  /// is kept where there is none.
  std::uint32_t find_or_keep(std::uint32_t index) {
    const Eigen::Vector3d point = points_[index].cast<double>();
    const std::array<std::int64_t, 3> cell = cell_of(point);
    std::uint32_t nearest = index;
    double least = tolerance_;
    for (int i = 0; i < 27; ++i) {
      const auto found =
          cells_.find(key_of({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1}));
      if (found == cells_.end()) continue;
      for (const std::uint32_t other : found->second) {
        const double distance = (points_[other].cast<double>() - point).norm();
        if (distance > least || (distance == least && nearest < other)) continue;
        least = distance;
        nearest = other;
      }
    }
    if (nearest == index) cells_[key_of(cell)].push_back(index);
    return nearest;
  }

 private:
  [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Eigen::Vector3d& point) const {
    const auto cell = [&](double x) {
      return static_cast<std::int64_t>(std::floor(x / tolerance_));
    };
    return {cell(point.x()), cell(point.y()), cell(point.z())};
  }

  /// Cells that have the same key by chance are far apart, so that distances separate them.
  static std::uint64_t key_of(const std::array<std::int64_t, 3>& cell) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21U) - 1;
    const auto bits = [&](std::int64_t x) { return static_cast<std::uint64_t>(x) & kMask; };
    return bits(cell[0]) << 42U | bits(cell[1]) << 21U | bits(cell[2]);
  }

  const std::vector<Eigen::Vector3f>& points_;
  double tolerance_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

TriangleMesh with_seams_welded(const TriangleMesh& mesh, const std::vector<bool>& is_open,
                               double tolerance) {
  PointsApart points(mesh.vertices, tolerance);
  TriangleMesh moved = mesh;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    if (is_open[v]) moved.vertices[v] = mesh.vertices[points.find_or_keep(v)];
  }
  return weld_vertices(moved);
}

}  // namespace

TriangleMesh with_closed_seams(const TriangleMesh& welded) {
  const std::vector<bool> is_open = vertices_of_open_edges(welded);
  const Eigen::AlignedBox3f box = bounds(welded.vertices);
  const double size = static_cast<double>(box.sizes().maxCoeff());
  const double farthest =
      static_cast<double>(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff());
  // Two last bits of the largest coordinate: what single precision makes of equal corners.
  const double rounding = 2.0 * std::numeric_limits<float>::epsilon() * farthest;
  // Text of six digits has 1e-6 of the size, and each of two corners may be rounded.
  for (const double tolerance :
       {rounding, std::max(1e-6 * size, 2.0 * rounding), std::max(3e-6 * size, 4.0 * rounding)}) {
    if (!(tolerance > 0.0)) break;
    TriangleMesh closed = with_seams_welded(welded, is_open, tolerance);
    if (find_open_edges(closed).count == 0) return closed;
  }
  return welded;
}

}  // namespace pcavr::model
