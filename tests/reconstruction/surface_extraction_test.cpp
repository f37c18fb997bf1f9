// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/surface_extraction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "perception/reconstruction/marching_cubes_table.hpp"

namespace pcavr {
namespace {

using GridField = std::function<int(int x, int y, int z)>;
constexpr int kGridBlocks = 3;
constexpr int kGridSide = kGridBlocks * kBlockSide;
constexpr float kGridVoxel = 0.01F;

/// Blocks around the origin with the distances [steps] of `field`, measured `hits` times each, in
/// the order of `first`, `first` + 1, ... of 27 blocks.
BlockMap grid_of(const GridField& field, std::uint32_t hits = 15, int first = 0) {
  BlockMap map;
  constexpr int kCount = kGridBlocks * kGridBlocks * kGridBlocks;
  for (int i = 0; i < kCount; ++i) {
    const int at = (first + i * 5) % kCount;
    const BlockCoordinates block{at % 3 - 1, at / 3 % 3 - 1, at / 9 - 1};
    VoxelBlock& voxels = map.block(map.add(block));
    for (int v = 0; v < kBlockVoxels; ++v) {
      const int steps = field(block.x * 8 + v % 8, block.y * 8 + v / 8 % 8, block.z * 8 + v / 64);
      const auto index = static_cast<std::size_t>(v);
      voxels.distance_weight[index] = (static_cast<std::uint32_t>(steps) & 0xFFFFU) | (256U << 16);
      voxels.color_counts[index] = hits << 24;
    }
  }
  return map;
}

/// Uniform in +-`max`, but outside (positive) at the border of the grid.
GridField random_field(std::uint64_t seed, int max) {
  const Random source(seed);
  return [source, max](int x, int y, int z) {
    const int to_border = std::min({x, y, z}) + 8;
    const int from_border = 15 - std::max({x, y, z});
    Random random = source.fork(static_cast<std::uint64_t>(((z + 8) * 24 + y + 8) * 24 + x + 8));
    const int value = static_cast<int>(random.below(static_cast<std::uint64_t>(2 * max + 1))) - max;
    return std::min(to_border, from_border) <= 0 ? std::abs(value) + 1 : value;
  };
}

using DirectedEdges = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;
DirectedEdges directed_edges_of(const TriangleMesh& mesh) {
  DirectedEdges edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  return edges;
}

TEST(ExtractSurface, IsClosedAndOrientedForAnyDistances) {
  // Random signs: all 256 cases and ambiguous faces, within blocks and across their borders.
  for (const int max : {1, 300, 32'000}) {
    const BlockMap map = grid_of(random_field(static_cast<std::uint64_t>(max), max));
    const TriangleMesh mesh = extract_surface(map, {kGridVoxel, 1.0, 3}, {1});
    ASSERT_GT(mesh.triangles.size(), 10'000U);
    for (const auto& [edge, count] : directed_edges_of(mesh)) {
      ASSERT_EQ(count, 1);
      ASSERT_TRUE(edge.first != edge.second);
    }
    const DirectedEdges edges = directed_edges_of(mesh);
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1U);
    }
    EXPECT_GT(signed_volume(mesh), 0.0);
  }
}

TEST(ExtractSurface, HasAVertexAtTheZeroCrossingOfEachEdgeAndNoOther) {
  const GridField field = random_field(11, 1000);
  const BlockMap map = grid_of(field);
  const TriangleMesh mesh = extract_surface(map, {kGridVoxel, 1.0, 3}, {1});
  const auto value = [&](int x, int y, int z) {
    const int steps = field(x, y, z);
    return steps == 0 ? 1 : steps;  // zero is outside
  };
  std::size_t crossings = 0;
  for (int z = -8; z < 16; ++z) {
    for (int y = -8; y < 16; ++y) {
      for (int x = -8; x < 16; ++x) {
        const bool here = value(x, y, z) < 0;
        crossings += x < 15 && here != (value(x + 1, y, z) < 0) ? 1 : 0;
        crossings += y < 15 && here != (value(x, y + 1, z) < 0) ? 1 : 0;
        crossings += z < 15 && here != (value(x, y, z + 1) < 0) ? 1 : 0;
      }
    }
  }
  ASSERT_EQ(mesh.vertices.size(), crossings);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d p = mesh.vertices[i].cast<double>() / kGridVoxel;
    // Off the grid on one axis: there the interpolated distance is zero, unless the vertex was
    // moved to 1/64 of the edge from its end. Float rounding of coordinates up to 16: 1e-5.
    Eigen::Index axis = 0;
    (p.array() - p.array().round()).abs().maxCoeff(&axis);
    Eigen::Vector3i low = p.array().round().cast<int>();
    low[axis] = static_cast<int>(std::floor(p[axis]));
    Eigen::Vector3i high = low;
    ++high[axis];
    const double a = value(low.x(), low.y(), low.z());
    const double b = value(high.x(), high.y(), high.z());
    ASSERT_LT(a * b, 0.0) << p.transpose();
    const double fraction = std::clamp(a / (a - b), 1.0 / 64.0, 63.0 / 64.0);
    ASSERT_NEAR(p[axis] - low[axis], fraction, 1e-5);
    ASSERT_NEAR(mesh.normals[i].norm(), 1.0F, 1e-5F);
  }
}

TEST(ExtractSurface, TrianglesHaveAnAreaAndFaceTheOutside) {
  // All triangles of a plane's distance field face along its normal, and no two vertices are nearer
  // than the distance between the nearest vertices on edges at one voxel: each is 1/64 of an edge
  // from it, so 1/64 sqrt(2) apart.
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const double offset = random.uniform(-3.0, 9.0);
    const BlockMap map = grid_of([&](int x, int y, int z) {
      return static_cast<int>(std::lround(512.0 * (normal.dot(Eigen::Vector3d(x, y, z)) - offset)));
    });
    const TriangleMesh mesh = extract_surface(map, {kGridVoxel, 1.0, 3}, {1});
    ASSERT_FALSE(mesh.triangles.empty());
    for (const auto& t : mesh.triangles) {
      const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
      const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
      const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>();
      const double nearest = std::min({(a - b).norm(), (b - c).norm(), (c - a).norm()});
      ASSERT_GT(nearest, 0.999 * std::sqrt(2.0) / 64.0 * kGridVoxel);
      ASSERT_GT((b - a).cross(c - a).dot(normal), 0.0);
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      // Half a step of rounding, and a vertex that was moved by up to 1/64 of an edge.
      ASSERT_NEAR(normal.dot(mesh.vertices[v].cast<double>()) / kGridVoxel, offset,
                  1.0 / 64.0 + 0.5 / 512.0 + 1e-5);
      // Central differences of values rounded to half a step: at most half a step per axis, of 512.
      ASSERT_GT(mesh.normals[v].cast<double>().dot(normal), 1.0 - 1e-5);
    }
  }
}

TEST(ExtractSurface, DoesNotDependOnTheOrderOfBlocksOrThreads) {
  const GridField field = random_field(5, 500);
  const auto sorted = [](const TriangleMesh& mesh) {
    std::vector<std::array<float, 9>> triangles;
    for (const auto& t : mesh.triangles) {
      std::array<std::array<float, 3>, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3f& p = mesh.vertices[t[i]];
        corners[i] = {p.x(), p.y(), p.z()};
      }
      // The lowest corner first, with the same winding.
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      std::array<float, 9> flat{};
      for (std::size_t i = 0; i < 9; ++i) flat[i] = corners[i / 3][i % 3];
      triangles.push_back(flat);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
  };
  const auto one = sorted(extract_surface(grid_of(field), {kGridVoxel, 1.0, 3}, {1}));
  for (const int first : {7, 13, 26}) {
    const BlockMap map = grid_of(field, 15, first);
    EXPECT_EQ(sorted(extract_surface(map, {kGridVoxel, 1.0, 3}, {3})), one);
  }
}

TEST(ExtractSurface, IgnoresVoxelsWithTooFewHits) {
  const BlockMap map = grid_of(random_field(6, 500), 4);
  const auto triangles = [&](double min_weight) {
    return extract_surface(map, {kGridVoxel, min_weight, 3}, {1}).triangles.size();
  };
  EXPECT_GT(triangles(4.0), 0U);
  EXPECT_EQ(triangles(4.0), triangles(-1.0));
  EXPECT_EQ(triangles(4.01), 0U);
  EXPECT_EQ(triangles(1e9), 0U);
  const BlockMap saturated = grid_of(random_field(6, 500), 15);
  EXPECT_EQ(extract_surface(saturated, {kGridVoxel, 1e9, 3}, {1}).triangles.size(), triangles(1.0));
}

TEST(ExtractSurface, NeedsFewerHitsWhereNoFrameContradicts) {
  const GridField field = random_field(6, 500);
  const auto triangles = [&](std::uint32_t hits, std::uint32_t frees, std::uint8_t of_block) {
    BlockMap map = grid_of(field, hits);
    for (std::uint32_t number = 0; number < map.size(); ++number) {
      map.block_free_count(number) = of_block;
      for (std::uint32_t& counts : map.block(number).color_counts) counts |= frees << 28;
    }
    const ExtractionParameters parameters{
        .voxel_size = kGridVoxel, .min_weight = 4.0, .min_uncontradicted_weight = 2.0};
    return extract_surface(map, parameters, {1}).triangles.size();
  };
  EXPECT_EQ(triangles(1, 0, 0), 0U);
  EXPECT_GT(triangles(2, 0, 0), 0U);
  EXPECT_EQ(triangles(3, 1, 0), 0U);
  EXPECT_EQ(triangles(3, 0, 1), 0U);
  EXPECT_EQ(triangles(4, 1, 0), triangles(2, 0, 0));
}

TEST(ExtractSurface, RemovesWhatAtLeastAsManyFramesSawAsFree) {
  const auto triangles = [&](std::uint32_t hits, std::uint32_t frees) {
    BlockMap map = grid_of(random_field(6, 500), hits);
    for (std::uint32_t number = 0; number < map.size(); ++number) {
      for (std::uint32_t& counts : map.block(number).color_counts) counts |= frees << 28;
    }
    return extract_surface(map, {kGridVoxel, 1.0, 3}, {1}).triangles.size();
  };
  for (const std::uint32_t hits : {5U, 15U}) {
    EXPECT_GT(triangles(hits, hits - 1), 0U);
    EXPECT_EQ(triangles(hits, hits), 0U);
  }
}

TEST(ExtractSurface, HasNoSurfaceWhereVoxelsOrTheirBlockWereFree) {
  const GridField field = random_field(8, 500);
  for (const std::uint32_t frames_to_clear : {1U, 3U, 15U}) {
    for (std::uint32_t of_block = 0; of_block <= frames_to_clear; ++of_block) {
      const auto triangles = [&](std::uint32_t of_voxels) {
        BlockMap map = grid_of(field, 1);
        for (std::uint32_t number = 0; number < map.size(); ++number) {
          map.block_free_count(number) = static_cast<std::uint8_t>(of_block);
          for (std::uint32_t& counts : map.block(number).color_counts) counts |= of_voxels << 28;
        }
        return extract_surface(map, {kGridVoxel, 1.0, static_cast<int>(frames_to_clear)}, {1})
            .triangles.size();
      };
      EXPECT_EQ(triangles(frames_to_clear - of_block), 0U);
      if (of_block < frames_to_clear) {
        EXPECT_GT(triangles(frames_to_clear - of_block - 1), 0U);
      }
    }
  }
}

TEST(MarchingCubesTable, SeparatesInsideFromOutsideForAnyPlane) {
  // The triangles of a cube lie on the zero plane of a linear field and face the positive side.
  Random random(9);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d normal =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const double offset =
        normal.dot(Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()));
    const auto corner = [](int c) { return Eigen::Vector3d(c & 1, c >> 1 & 1, c >> 2); };
    std::size_t inside = 0;
    for (int c = 0; c < 8; ++c) {
      if (normal.dot(corner(c)) < offset) inside |= std::size_t{1} << c;
    }
    const CubeCase& cube = marching_cubes_table()[inside];
    ASSERT_GT(cube.triangles, 0);
    const auto on_edge = [&](std::uint8_t e) {
      const CubeEdge edge = cube_edges()[e];
      const Eigen::Vector3d from = corner(edge.from);
      const Eigen::Vector3d to = corner(edge.from | (1 << edge.axis));
      const double a = normal.dot(from) - offset;
      const double b = normal.dot(to) - offset;
      return Eigen::Vector3d(from + (to - from) * (a / (a - b)));
    };
    for (std::size_t t = 0; t < cube.triangles; ++t) {
      const Eigen::Vector3d a = on_edge(cube.corners[t][0]);
      const Eigen::Vector3d b = on_edge(cube.corners[t][1]);
      const Eigen::Vector3d c = on_edge(cube.corners[t][2]);
      // A polygon in a plane is convex: its triangles have one orientation.
      EXPECT_GT((b - a).cross(c - a).dot(normal), -1e-12);
    }
  }
}

}  // namespace
}  // namespace pcavr
