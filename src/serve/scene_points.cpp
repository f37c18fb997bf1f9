// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "pcavr/base/core/raw_bytes.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pixel.hpp"
#include "pcavr/perception/scene/octomap_file.hpp"
#include "pcavr/perception/scene/ply_file.hpp"

namespace pcavr {
namespace {

using Cell = std::array<std::uint16_t, 3>;

constexpr int kMaxSteps = std::numeric_limits<std::uint16_t>::max();

/// A cell's Morton code (Z-order curve): the bits of its coordinates, interleaved.
std::uint64_t morton(const Cell& cell) {
  std::uint64_t code = 0;
  for (std::size_t bit = 0; bit < 16; ++bit) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      code |= std::uint64_t{cell[axis] >> bit & 1U} << (3 * bit + axis);
    }
  }
  return code;
}

/// The header of both files.
void append_header(std::string& bytes, const Eigen::Vector3f& origin, float step,
                   std::size_t count) {
  for (const float coordinate : origin) append_bytes(bytes, coordinate);
  append_bytes(bytes, step);
  append_bytes(bytes, static_cast<std::uint32_t>(count));
}

void append_cell(std::string& bytes, const Cell& cell) {
  for (const std::uint16_t coordinate : cell) append_bytes(bytes, coordinate);
}

Cell cell_of(const Eigen::Vector3f& point, const Eigen::Vector3f& origin, float step) {
  const Eigen::Vector3d steps = (point - origin).cast<double>() / double{step};
  Cell cell{};
  for (int axis = 0; axis < 3; ++axis) {
    cell[static_cast<std::size_t>(axis)] =
        static_cast<std::uint16_t>(clamp_to_int(std::round(steps[axis]), 0, kMaxSteps));
  }
  return cell;
}

/// The points that are kept, in Morton order; those with equal cells stay in the cloud's order.
std::vector<std::size_t> kept_points(const std::vector<Cell>& cells, std::size_t max_points) {
  std::vector<std::uint64_t> codes(cells.size());
  std::transform(cells.begin(), cells.end(), codes.begin(), morton);
  std::vector<std::size_t> order(cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return codes[a] < codes[b]; });
  const std::size_t stride = (cells.size() + max_points - 1) / max_points;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < order.size(); i += stride) kept.push_back(order[i]);
  return kept;
}

}  // namespace

Expected<PageCloud> page_cloud(const std::filesystem::path& cloud_ply,
                               const ContentOptions& options) {
  const Expected<TriangleMesh> cloud = read_ply(cloud_ply);
  if (!cloud) return cloud.error();
  const Eigen::AlignedBox3f box = bounds(cloud->vertices);
  const Eigen::Vector3f origin = box.isEmpty() ? Eigen::Vector3f(0, 0, 0) : box.min();
  const float extent = box.isEmpty() ? 0.0F : box.sizes().maxCoeff();
  const auto step =
      static_cast<float>(std::max(double{extent} / kMaxSteps, options.min_point_step));
  std::vector<Cell> cells;
  cells.reserve(cloud->vertices.size());
  for (const Eigen::Vector3f& point : cloud->vertices) {
    cells.push_back(cell_of(point, origin, step));
  }
  const std::vector<std::size_t> kept =
      kept_points(cells, static_cast<std::size_t>(options.max_points));
  PageCloud page{.bytes = {}, .points = kept.size()};
  append_header(page.bytes, origin, step, kept.size());
  for (const std::size_t i : kept) append_cell(page.bytes, cells[i]);
  for (const std::size_t i : kept) {
    const Rgb8 color = cloud->colors.empty() ? Rgb8{255, 255, 255} : cloud->colors[i];
    for (const std::uint8_t channel : {color.r, color.g, color.b}) {
      append_bytes(page.bytes, channel);
    }
  }
  return page;
}

Expected<PageOccupancy> page_occupancy(const std::filesystem::path& occupancy_bt,
                                       const ContentOptions& options) {
  const auto max_cells = static_cast<std::uint64_t>(options.max_cells);
  std::vector<Eigen::Vector3i> cells;
  const auto add_leaf = [&](const OctomapLeaf& leaf) {
    const std::int64_t edge = leaf.edge;
    const auto count = static_cast<std::uint64_t>(edge * edge * edge);
    if (!leaf.is_occupied || cells.size() + count > max_cells) return;
    for (std::int64_t i = 0; i < edge * edge * edge; ++i) {
      const Eigen::Matrix<std::int64_t, 3, 1> offset(i % edge, i / edge % edge, i / (edge * edge));
      cells.push_back(leaf.corner + offset.cast<int>());
    }
  };
  const Expected<OctomapContent> map = read_octomap(occupancy_bt, add_leaf);
  if (!map) return map.error();
  if (map->occupied > max_cells) {
    return Error{.message = std::to_string(map->occupied) + " occupied cells exceed the limit of " +
                            std::to_string(max_cells) + " that a page can show",
                 .file = occupancy_bt.string(),
                 .hint = "build the scene with a larger --occupancy-resolution"};
  }
  Eigen::Vector3i first = cells.empty() ? Eigen::Vector3i(0, 0, 0) : cells.front();
  for (const Eigen::Vector3i& cell : cells) first = first.cwiseMin(cell);
  PageOccupancy page{.bytes = {}, .cells = cells.size(), .edge = map->resolution};
  const Eigen::Vector3f origin = (first.cast<double>() * map->resolution).cast<float>();
  append_header(page.bytes, origin, static_cast<float>(map->resolution), cells.size());
  for (const Eigen::Vector3i& cell : cells) {
    // An OctoMap is 65 536 cells wide.
    const Eigen::Vector3i offset = cell - first;
    append_cell(page.bytes,
                {static_cast<std::uint16_t>(offset.x()), static_cast<std::uint16_t>(offset.y()),
                 static_cast<std::uint16_t>(offset.z())});
  }
  return page;
}

}  // namespace pcavr
