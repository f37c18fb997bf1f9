// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "occupancy_state.hpp"

namespace pcavr {
namespace {

struct Triangle {
  Eigen::Vector3d a, b, c;
};

/// Calls `visit` with bounding boxes of the pieces of a triangle that is bisected at its longest
/// side until no side is longer than `max_edge`.
template <typename Visit>
void visit_pieces(const Triangle& triangle, double max_edge, const Visit& visit) {
  const auto& [a, b, c] = triangle;
  const double ab = (b - a).squaredNorm();
  const double bc = (c - b).squaredNorm();
  const double ca = (a - c).squaredNorm();
  const double longest = std::max({ab, bc, ca});
  if (!std::isfinite(longest)) return;
  if (longest <= max_edge * max_edge) {
    Eigen::AlignedBox3d box(a);
    visit(box.extend(b).extend(c));
    return;
  }
  // Vertices rotated so that the longest side is the first.
  const Triangle rotated = longest == ab   ? triangle
                           : longest == bc ? Triangle{b, c, a}
                                           : Triangle{c, a, b};
  const Eigen::Vector3d middle = 0.5 * (rotated.a + rotated.b);
  visit_pieces({rotated.a, middle, rotated.c}, max_edge, visit);
  visit_pieces({middle, rotated.b, rotated.c}, max_edge, visit);
}

constexpr double kMargin = 0.5;  ///< max distance from a cell to its supporting surface [cells]
constexpr double kPieceLength = 0.5;  ///< of a triangle's pieces [cells]

/// Calls `visit` with every cell that a box [cells] intersects.
template <typename Visit>
void for_each_cell(const Eigen::AlignedBox3d& box, const Visit& visit) {
  const Eigen::Vector3i low = box.min().array().floor().cast<int>();
  const Eigen::Vector3i high = box.max().array().floor().cast<int>();
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int z = low.z(); z <= high.z(); ++z) visit(Eigen::Vector3i(x, y, z));
    }
  }
}

/// Calls `visit` with small boxes [cells] that cover the mesh.
template <typename Visit>
void visit_mesh_pieces(const TriangleMesh& mesh_base, double resolution, const Visit& visit) {
  const auto corner = [&](std::uint32_t vertex) {
    return Eigen::Vector3d(mesh_base.vertices[vertex].cast<double>() / resolution);
  };
  for (const auto& [a, b, c] : mesh_base.triangles) {
    visit_pieces({corner(a), corner(b), corner(c)}, kPieceLength, visit);
  }
}

}  // namespace

std::size_t OccupancyMap::clear_unsupported(const TriangleMesh& static_mesh_base) {
  std::vector<BlockBits> is_supported(state_->blocks.size(), BlockBits{});
  const auto mark_supported = [&](const Eigen::AlignedBox3d& box) {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kMargin);
    for_each_cell({box.min() - margin, box.max() + margin}, [&](const Eigen::Vector3i& cell) {
      const auto index = state_->index_of(cell);
      if (!index) return;
      is_supported[index->block][index->cell / 64] |= std::uint64_t{1} << (index->cell % 64);
    });
  };
  visit_mesh_pieces(static_mesh_base, state_->options.resolution, mark_supported);

  std::size_t cleared = 0;
  for (std::size_t i = 0; i < state_->blocks.size(); ++i) {
    for (std::size_t cell = 0; cell < kBlockCells; ++cell) {
      std::int16_t& value = state_->blocks[i].values[cell];
      const bool supported = (is_supported[i][cell / 64] >> (cell % 64) & 1) != 0;
      if (value < 0 || supported) continue;
      value = kUnknown;
      ++cleared;
    }
  }
  return cleared;
}

void OccupancyMap::mark_occupied(const TriangleMesh& mesh_base) {
  visit_mesh_pieces(mesh_base, state_->options.resolution, [&](const Eigen::AlignedBox3d& box) {
    if (box.min().cwiseAbs().maxCoeff() > kMaxCell) return;
    for_each_cell(box, [&](const Eigen::Vector3i& cell) {
      OccupancyBlock& block = state_->block_at(cell.unaryExpr([](int c) { return c >> 3; }));
      block.values[state_->index_of(cell)->cell] = static_cast<std::int16_t>(state_->clamping_max);
    });
  });
}

}  // namespace pcavr
