// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/guard_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/perception/scene/occupancy_tree.hpp"
#include "pcavr/perception/scene/scene_text.hpp"

namespace pcavr {
namespace {

/// Largest grid around a grown scan: 200 MB of distances.
constexpr double kMaxGridPoints = 5e7;

TriangleMesh box_mesh(const GuardBox& box) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                               (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices.emplace_back((box.T_base_box * sign.cwiseProduct(box.size).eval()).cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh plane_mesh(const GuardPlane& plane) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), plane.normal);
  TriangleMesh mesh;
  for (const auto& [x, y] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const Eigen::Vector3d corner(x * plane.size, y * plane.size, 0.0);
    mesh.vertices.emplace_back((plane.point + turn * corner).cast<float>());
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Distances to the occupied cells on a grid, up to a little beyond the margin.
class DistanceGrid {
 public:
  DistanceGrid(const Eigen::AlignedBox3d& occupied, double spacing, double reach)
      : spacing_(spacing), reach_(reach) {
    origin_ = occupied.min().array() - reach - spacing;
    const Eigen::Vector3d span = occupied.sizes().array() + 2.0 * (reach + spacing);
    size_ = (span / spacing).array().ceil().cast<int>() + 2;
  }

  [[nodiscard]] double point_count() const { return size_.cast<double>().prod(); }
  [[nodiscard]] const Eigen::Vector3i& size() const { return size_; }
  void allocate() { distance_.assign(static_cast<std::size_t>(point_count()), far()); }

  /// Lowers the distances around one occupied cube.
  void add(const Eigen::Vector3d& centre, double edge) {
    const double half = 0.5 * edge;
    const Eigen::Vector3i low = index_below(centre.array() - half - reach_);
    const Eigen::Vector3i high = index_below(centre.array() + half + reach_);
    for (int z = low.z(); z <= high.z() + 1; ++z) {
      for (int y = low.y(); y <= high.y() + 1; ++y) {
        for (int x = low.x(); x <= high.x() + 1; ++x) {
          const Eigen::Vector3i at(x, y, z);
          const Eigen::Array3d outside =
              ((point(at.cast<double>()) - centre).array().abs() - half).max(0.0);
          float& known = distance_[offset(at)];
          known = std::min(known, static_cast<float>(outside.matrix().norm()));
        }
      }
    }
  }

  [[nodiscard]] double at(const Eigen::Vector3i& index) const { return distance_[offset(index)]; }
  [[nodiscard]] Eigen::Vector3d point(const Eigen::Vector3d& index) const {
    return origin_ + spacing_ * index;
  }
  [[nodiscard]] std::size_t offset(const Eigen::Vector3i& at) const {
    return static_cast<std::size_t>(at.x()) +
           static_cast<std::size_t>(size_.x()) *
               (static_cast<std::size_t>(at.y()) +
                static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(at.z()));
  }

 private:
  [[nodiscard]] float far() const { return static_cast<float>(reach_ + spacing_); }
  [[nodiscard]] Eigen::Vector3i index_below(const Eigen::Vector3d& p) const {
    return ((p - origin_) / spacing_).array().floor().cast<int>().max(0).min(size_.array() - 2);
  }

  double spacing_, reach_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<float> distance_;
};

constexpr std::array<std::pair<int, int>, 12> kCellEdges{{{0, 1},
                                                          {2, 3},
                                                          {4, 5},
                                                          {6, 7},
                                                          {0, 2},
                                                          {1, 3},
                                                          {4, 6},
                                                          {5, 7},
                                                          {0, 4},
                                                          {1, 5},
                                                          {2, 6},
                                                          {3, 7}}};

Eigen::Vector3i corner_of(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2 & 1}; }

/// The surface's point in one cell: the mean of its crossings with the cell's edges; nothing where
/// the surface does not cross it [Gibson 1998, constrained elastic surface nets].
std::optional<Eigen::Vector3d> cell_point(const DistanceGrid& grid, const Eigen::Vector3i& cell,
                                          double margin) {
  std::array<double, 8> value{};
  for (int i = 0; i < 8; ++i) {
    value[static_cast<std::size_t>(i)] = grid.at(cell + corner_of(i)) - margin;
  }
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const auto& [a, b] : kCellEdges) {
    const double from = value[static_cast<std::size_t>(a)];
    const double to = value[static_cast<std::size_t>(b)];
    if ((from < 0.0) == (to < 0.0)) continue;
    const Eigen::Vector3d begin = corner_of(a).cast<double>();
    sum += begin + from / (from - to) * (corner_of(b).cast<double>() - begin);
    count += 1.0;
  }
  if (count == 0.0) return std::nullopt;
  return grid.point(cell.cast<double>() + sum / count);
}

/// The surface where the distance is `margin`: a vertex in each cell that it crosses, two triangles
/// across each of the grid's edges that it crosses.
TriangleMesh surface_at(const DistanceGrid& grid, double margin) {
  TriangleMesh mesh;
  const Eigen::Vector3i cells = grid.size().array() - 1;
  std::vector<std::int32_t> vertex(static_cast<std::size_t>(grid.point_count()), -1);
  const auto for_each_cell = [&cells](auto&& use) {
    for (int z = 0; z < cells.z(); ++z) {
      for (int y = 0; y < cells.y(); ++y) {
        for (int x = 0; x < cells.x(); ++x) use(Eigen::Vector3i(x, y, z));
      }
    }
  };
  for_each_cell([&](const Eigen::Vector3i& cell) {
    const auto point = cell_point(grid, cell, margin);
    if (!point) return;
    vertex[grid.offset(cell)] = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(point->cast<float>());
  });
  for_each_cell([&](const Eigen::Vector3i& cell) {
    if (cell.minCoeff() == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i next = cell + Eigen::Vector3i::Unit(axis);
      if ((grid.at(cell) < margin) == (grid.at(next) < margin)) continue;
      const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3);
      const Eigen::Vector3i v = Eigen::Vector3i::Unit((axis + 2) % 3);
      std::array<std::int32_t, 4> corners{vertex[grid.offset(cell - u - v)],
                                          vertex[grid.offset(cell - v)], vertex[grid.offset(cell)],
                                          vertex[grid.offset(cell - u)]};
      if (grid.at(next) < margin) std::swap(corners[1], corners[3]);  // outwards
      mesh.triangles.push_back({static_cast<std::uint32_t>(corners[0]),
                                static_cast<std::uint32_t>(corners[1]),
                                static_cast<std::uint32_t>(corners[2])});
      mesh.triangles.push_back({static_cast<std::uint32_t>(corners[0]),
                                static_cast<std::uint32_t>(corners[2]),
                                static_cast<std::uint32_t>(corners[3])});
    }
  });
  return mesh;
}

Expected<TriangleMesh> scan_mesh(const std::string& name, const GuardScan& scan,
                                 const std::filesystem::path& map_file) {
  const Expected<OccupancyTree> map = OccupancyTree::read(map_file);
  if (!map) return map.error();
  Eigen::AlignedBox3d occupied;
  map->for_each_occupied([&](const Eigen::Vector3d& centre, double edge) {
    occupied.extend(Eigen::Vector3d(centre.array() - 0.5 * edge));
    occupied.extend(Eigen::Vector3d(centre.array() + 0.5 * edge));
  });
  if (occupied.isEmpty()) {
    return Error{.message = "guard " + name + ": the map has no occupied cell to grow",
                 .file = map_file.string(),
                 .hint = "use a box or a plane as guard"};
  }
  // Two grid points across the margin, at least.
  const double spacing = std::min(map->resolution(), 0.5 * scan.margin);
  DistanceGrid grid(occupied, spacing, scan.margin + 2.0 * spacing);
  if (grid.point_count() > kMaxGridPoints) {
    return Error{.message = "guard " + name + ": the map is too large for a margin this small",
                 .file = map_file.string(),
                 .hint = "use a larger margin, or boxes around the equipment"};
  }
  grid.allocate();
  map->for_each_occupied(
      [&](const Eigen::Vector3d& centre, double edge) { grid.add(centre, edge); });
  return surface_at(grid, scan.margin);
}

/// Distance from the box's surface or inside, 0 inside.
double distance_to(const GuardBox& box, const Eigen::Vector3d& p_base) {
  const Eigen::Vector3d p_box = box.T_base_box.inverse() * p_base;
  return (p_box.array().abs() - 0.5 * box.size.array()).max(0.0).matrix().norm();
}

/// Whether a point is behind the sheet or within `radius` before it; beside it the tool is free.
bool is_behind(const GuardPlane& plane, const Eigen::Vector3d& p_base, double radius) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), plane.normal);
  const Eigen::Vector3d p_plane = turn.conjugate() * (p_base - plane.point);
  const double half = 0.5 * plane.size + radius;
  return p_plane.head<2>().cwiseAbs().maxCoeff() < half && p_plane.z() < radius;
}

}  // namespace

Expected<TriangleMesh> guard_mesh(const GuardSurface& guard,
                                  const std::filesystem::path& scene_folder) {
  if (const auto* box = std::get_if<GuardBox>(&guard.shape)) return box_mesh(*box);
  if (const auto* plane = std::get_if<GuardPlane>(&guard.shape)) return plane_mesh(*plane);
  return scan_mesh(guard.name, std::get<GuardScan>(guard.shape), scene_folder / kOccupancyFile);
}

Expected<bool> is_guarded(const GuardSurface& guard, const std::filesystem::path& scene_folder,
                          const Eigen::Vector3d& p_base, double radius) {
  if (const auto* box = std::get_if<GuardBox>(&guard.shape)) {
    return distance_to(*box, p_base) < radius;
  }
  if (const auto* plane = std::get_if<GuardPlane>(&guard.shape)) {
    return is_behind(*plane, p_base, radius);
  }
  const Expected<OccupancyTree> map = OccupancyTree::read(scene_folder / kOccupancyFile);
  if (!map) return map.error();
  return map->clearance(p_base, std::get<GuardScan>(guard.shape).margin + radius).has_value();
}

}  // namespace pcavr
