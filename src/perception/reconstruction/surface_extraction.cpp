// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/surface_extraction.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "perception/reconstruction/marching_cubes_table.hpp"
#include "perception/reconstruction/surface_map.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMeshGrainBlocks = 64;  // amortises the scheduling of a task
// Minimum distance of a zero crossing from the voxels, in edge lengths: closer, the vertices of
// several edges would coincide.
constexpr float kMinFraction = 1.0F / 64.0F;

/// Hits that make a voxel's distance known.
struct MinHits {
  std::uint32_t contradicted;    ///< [frames], where any frame observed the voxel as free
  std::uint32_t uncontradicted;  ///< [frames], where none did
  std::uint32_t frames_to_clear;
};

std::uint32_t to_hits(double weight) {
  return static_cast<std::uint32_t>(std::clamp(std::ceil(weight), 1.0, double{kMaxCount}));
}

/// The signed distances of a block, or kUnknownDistance. A surface that as many frames observed as
/// free as measured it is removed (space carving): a negative distance becomes unknown, a positive
/// one stays.
void decode(const VoxelBlock& block, std::uint32_t block_free_count, const MinHits& min_hits,
            Distances& distances) {
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    const std::uint32_t counts = block.color_counts[i];
    const std::uint32_t hits = hit_count(counts);
    const int steps = distance_steps(block.distance_weight[i]);
    const std::uint32_t frees = free_count(counts) + block_free_count;
    const bool is_free = frees >= std::max(min_hits.frames_to_clear, hits);
    const std::uint32_t needed = frees == 0 ? min_hits.uncontradicted : min_hits.contradicted;
    const bool is_known = hits >= needed && !(is_free && steps <= 0);
    // Never exactly zero, so that each vertex belongs to one edge.
    const int distance = steps == 0 ? 1 : std::max(steps, -32767);
    distances[i] = is_known ? static_cast<std::int16_t>(distance) : kUnknownDistance;
  }
}

/// Gradient of the distance field at a voxel [steps]: central differences, one-sided where a
/// neighbour is unknown.
Eigen::Vector3f gradient_at(const Window& window, const std::array<int, 3>& at) {
  Eigen::Vector3f gradient;
  const std::int16_t centre = window(at[0], at[1], at[2]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<int, 3> low = at;
    std::array<int, 3> high = at;
    --low[axis];
    ++high[axis];
    const std::int16_t before = window(low[0], low[1], low[2]);
    const std::int16_t after = window(high[0], high[1], high[2]);
    float slope = 0.0F;
    if (before != kUnknownDistance && after != kUnknownDistance) {
      slope = 0.5F * static_cast<float>(after - before);
    } else if (after != kUnknownDistance) {
      slope = static_cast<float>(after - centre);
    } else if (before != kUnknownDistance) {
      slope = static_cast<float>(centre - before);
    }
    gradient[static_cast<Eigen::Index>(axis)] = slope;
  }
  return gradient;
}

Rgb8 interpolated_color(std::uint32_t a, std::uint32_t b, float fraction) {
  // A voxel without a colour takes that of the edge's other end.
  if ((a & 0xFFFFFFU) == 0) a = b;
  if ((b & 0xFFFFFFU) == 0) b = a;
  const auto channel = [&](int shift) {
    const auto from = static_cast<float>((a >> shift) & 255U);
    const auto to = static_cast<float>((b >> shift) & 255U);
    return static_cast<std::uint8_t>(from + (to - from) * fraction + 0.5F);
  };
  return {channel(0), channel(8), channel(16)};
}

/// Writes one block's part of the mesh.
class BlockMesher {
 public:
  BlockMesher(const BlockMap& map, const std::vector<SurfaceMap>& surfaces,
              const Neighbours& neighbours, const Window& window, float voxel_size)
      : map_(map),
        surfaces_(surfaces),
        neighbours_(neighbours),
        window_(window),
        voxel_size_(voxel_size) {}

  void add_vertices(std::uint32_t number, TriangleMesh& mesh) const {
    for_each_vertex(surfaces_[number],
                    [&](const std::array<int, 3>& at, std::size_t axis, std::uint32_t index) {
                      add_vertex(map_.coordinates(number), at, axis, index, mesh);
                    });
  }

  void add_triangles(std::uint32_t number, const SignRows& signs, TriangleMesh& mesh) const {
    const SurfaceMap& surface = surfaces_[number];
    std::size_t next = surface.first_triangle;
    for (std::size_t z = 0; z < 8; ++z) {
      for (std::uint64_t left = surface.cubes[z]; left != 0; left &= left - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(left));
        const std::size_t x = bit % 8;
        const std::size_t y = bit / 8;
        const CubeCase& cube =
            marching_cubes_table()[static_cast<std::size_t>(signs.cube_case(x + 1, y + 1, z + 1))];
        std::array<std::uint32_t, 12> vertex_of{};
        for (std::uint32_t edges = cube.edges; edges != 0; edges &= edges - 1) {
          const auto e = static_cast<std::size_t>(std::countr_zero(edges));
          vertex_of[e] = vertex_on(x, y, z, cube_edges()[e]);
        }
        for (std::size_t t = 0; t < cube.triangles; ++t) {
          const auto& corners = cube.corners[t];
          mesh.triangles[next++] = {vertex_of[corners[0]], vertex_of[corners[1]],
                                    vertex_of[corners[2]]};
        }
      }
    }
  }

 private:
  void add_vertex(const BlockCoordinates& coordinates, const std::array<int, 3>& at,
                  std::size_t axis, std::size_t index, TriangleMesh& mesh) const {
    std::array<int, 3> end = at;
    ++end[axis];
    const auto a = static_cast<float>(window_(at[0], at[1], at[2]));
    const auto b = static_cast<float>(window_(end[0], end[1], end[2]));
    const float fraction = std::clamp(a / (a - b), kMinFraction, 1.0F - kMinFraction);
    Eigen::Vector3f p(static_cast<float>(coordinates.x * kBlockSide + at[0]),
                      static_cast<float>(coordinates.y * kBlockSide + at[1]),
                      static_cast<float>(coordinates.z * kBlockSide + at[2]));
    p[static_cast<Eigen::Index>(axis)] += fraction;
    mesh.vertices[index] = p * voxel_size_;
    const Eigen::Vector3f normal =
        (1.0F - fraction) * gradient_at(window_, at) + fraction * gradient_at(window_, end);
    const float length = normal.norm();
    mesh.normals[index] =
        length > 0.0F ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::UnitZ();
    mesh.colors[index] = interpolated_color(color_at(at), color_at(end), fraction);
  }

  [[nodiscard]] std::uint32_t color_at(const std::array<int, 3>& at) const {
    // Ends of edges have coordinates 0 to 8.
    const int side = (at[2] / 8 + 1) * 9 + (at[1] / 8 + 1) * 3 + at[0] / 8 + 1;
    const int voxel = (at[2] % 8 * kBlockSide + at[1] % 8) * kBlockSide + at[0] % 8;
    return map_.block(neighbours_[static_cast<std::size_t>(side)])
        .color_counts[static_cast<std::size_t>(voxel)];
  }

  [[nodiscard]] std::uint32_t vertex_on(std::size_t x, std::size_t y, std::size_t z,
                                        CubeEdge edge) const {
    x += edge.from & 1U;
    y += (edge.from >> 1) & 1U;
    z += (edge.from >> 2) & 1U;
    const std::size_t side = (z / 8 + 1) * 9 + (y / 8 + 1) * 3 + x / 8 + 1;
    const SurfaceMap& owner = surfaces_[neighbours_[side]];
    const std::size_t bit = y % 8 * 8 + x % 8;
    const std::uint64_t below = owner.edges[edge.axis][z % 8] & ((std::uint64_t{1} << bit) - 1);
    return owner.first_vertex + owner.before[edge.axis][z % 8] +
           static_cast<std::uint32_t>(std::popcount(below));
  }

  const BlockMap& map_;
  const std::vector<SurfaceMap>& surfaces_;
  const Neighbours& neighbours_;
  const Window& window_;
  float voxel_size_;
};

std::vector<Distances> decode_all(const BlockMap& map, const ExtractionParameters& parameters,
                                  Parallelism parallelism) {
  const MinHits min_hits{.contradicted = to_hits(parameters.min_weight),
                         .uncontradicted = to_hits(
                             parameters.min_uncontradicted_weight.value_or(parameters.min_weight)),
                         .frames_to_clear = static_cast<std::uint32_t>(parameters.frames_to_clear)};
  std::vector<Distances> distances(map.size());
  parallel_for(parallelism, map.size(), kMeshGrainBlocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      decode(map.block(number), map.block_free_count(number), min_hits, distances[i]);
    }
  });
  return distances;
}

/// The blocks whose surface is extracted; all of the map where `part` is empty.
class Owned {
 public:
  Owned(const BlockMap& map, const std::optional<BlockBox>& part) : map_(map), part_(part) {}
  [[nodiscard]] bool operator()(std::uint32_t number) const {
    if (!part_) return true;
    const BlockCoordinates& at = map_.coordinates(number);
    return part_->contains({at.x, at.y, at.z});
  }

 private:
  const BlockMap& map_;
  const std::optional<BlockBox>& part_;
};

/// Assigns each block its offsets in the mesh (prefix sum), first the owned ones; returns the
/// counts of owned vertices and triangles.
std::pair<std::size_t, std::size_t> assign_offsets(std::vector<SurfaceMap>& surfaces,
                                                   const Owned& is_owned) {
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  const auto assign = [&](bool owned) {
    for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
      if (is_owned(i) != owned) continue;
      surfaces[i].first_vertex = vertices;
      surfaces[i].first_triangle = triangles;
      vertices += surfaces[i].vertices;
      if (owned) triangles += surfaces[i].triangles;
    }
  };
  assign(true);
  const std::size_t owned_vertices = vertices;
  assign(false);
  return {owned_vertices, triangles};
}

GridEdge grid_edge(const BlockCoordinates& block, const std::array<int, 3>& at, std::size_t axis) {
  return {block.x * kBlockSide + at[0], block.y * kBlockSide + at[1], block.z * kBlockSide + at[2],
          static_cast<int>(axis)};
}

/// Renumbers the vertices that the triangles use of blocks that are not owned: 0 is the first of
/// `borrowed`, behind the owned ones.
void name_borrowed(const BlockMap& map, const std::vector<SurfaceMap>& surfaces,
                   const Owned& is_owned, SurfaceTile& tile) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFFU;
  const std::size_t owned = tile.mesh.vertices.size();
  std::size_t others = 0;
  for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
    if (!is_owned(i)) others += surfaces[i].vertices;
  }
  std::vector<std::uint32_t> number(others, kUnused);
  for (const auto& triangle : tile.mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v >= owned) number[v - owned] = 0;
    }
  }
  for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
    if (is_owned(i)) continue;
    for_each_vertex(
        surfaces[i], [&](const std::array<int, 3>& at, std::size_t axis, std::uint32_t index) {
          if (number[index - owned] == kUnused) return;
          number[index - owned] = static_cast<std::uint32_t>(owned + tile.borrowed.size());
          tile.borrowed.push_back(grid_edge(map.coordinates(i), at, axis));
        });
  }
  for (auto& triangle : tile.mesh.triangles) {
    for (std::uint32_t& v : triangle) v = v < owned ? v : number[v - owned];
  }
}

/// The owned vertices that cubes of other tiles touch: those on the box's low faces.
void name_lent(const BlockMap& map, const std::vector<SurfaceMap>& surfaces, const BlockBox& part,
               SurfaceTile& tile) {
  for (std::uint32_t i = 0; i < surfaces.size(); ++i) {
    const BlockCoordinates& block = map.coordinates(i);
    const Eigen::Vector3i at_block(block.x, block.y, block.z);
    const Eigen::Array<bool, 3, 1> is_first = at_block.array() == part.low.array();
    if (!part.contains(at_block) || !is_first.any()) continue;
    for_each_vertex(surfaces[i],
                    [&](const std::array<int, 3>& at, std::size_t axis, std::uint32_t index) {
                      for (Eigen::Index k = 0; k < 3; ++k) {
                        if (!is_first[k] || at[static_cast<std::size_t>(k)] != 0) continue;
                        tile.lent.emplace_back(grid_edge(block, at, axis), index);
                        return;
                      }
                    });
  }
}

}  // namespace

TriangleMesh extract_surface(const BlockMap& map, const ExtractionParameters& parameters,
                             Parallelism parallelism) {
  return extract_tile(map, parameters, {}, parallelism).mesh;
}

SurfaceTile extract_tile(const BlockMap& map, const ExtractionParameters& parameters,
                         const std::optional<BlockBox>& part, Parallelism parallelism) {
  const std::vector<Distances> distances = decode_all(map, parameters, parallelism);
  std::vector<SurfaceMap> surfaces(map.size());
  parallel_for(parallelism, map.size(), kMeshGrainBlocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Window window(distances, neighbours_of(map, static_cast<std::uint32_t>(i)));
      surfaces[i] = map_surface(SignRows(window));
    }
  });
  const Owned is_owned(map, part);
  const auto [vertices, triangles] = assign_offsets(surfaces, is_owned);
  SurfaceTile tile;
  TriangleMesh& mesh = tile.mesh;
  mesh.vertices.resize(vertices);
  mesh.normals.resize(vertices);
  mesh.colors.resize(vertices);
  mesh.triangles.resize(triangles);
  parallel_for(parallelism, map.size(), kMeshGrainBlocks, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto number = static_cast<std::uint32_t>(i);
      if (!is_owned(number)) continue;
      if (surfaces[i].vertices == 0 && surfaces[i].triangles == 0) continue;
      const Neighbours neighbours = neighbours_of(map, number);
      const Window window(distances, neighbours);
      const BlockMesher mesher(map, surfaces, neighbours, window,
                               static_cast<float>(parameters.voxel_size));
      mesher.add_vertices(number, mesh);
      mesher.add_triangles(number, SignRows(window), mesh);
    }
  });
  if (!part) return tile;
  name_borrowed(map, surfaces, is_owned, tile);
  name_lent(map, surfaces, *part, tile);
  return tile;
}

}  // namespace pcavr
