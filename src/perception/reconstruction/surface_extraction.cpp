// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/surface_extraction.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "perception/reconstruction/marching_cubes_table.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMeshGrainBlocks = 64;  // amortises the scheduling of a task
constexpr std::int16_t kUnknown = std::numeric_limits<std::int16_t>::min();
// Minimum distance of a zero crossing from the voxels, in edge lengths: closer, the vertices of
// several edges would coincide.
constexpr float kMinFraction = 1.0F / 64.0F;

using Distances = std::array<std::int16_t, kBlockVoxels>;

/// Hits that make a voxel's distance known.
struct MinHits {
  std::uint32_t contradicted;    ///< [frames], where any frame observed the voxel as free
  std::uint32_t uncontradicted;  ///< [frames], where none did
  std::uint32_t frames_to_clear;
};

std::uint32_t to_hits(double weight) {
  return static_cast<std::uint32_t>(std::clamp(std::ceil(weight), 1.0, double{kMaxCount}));
}

/// The signed distances of a block, or kUnknown. A surface that as many frames observed as free as
/// measured it is removed (space carving): a negative distance becomes unknown, a positive one
/// stays.
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
    distances[i] = is_known ? static_cast<std::int16_t>(distance) : kUnknown;
  }
}

/// Numbers of the 3x3x3 blocks around a block, x fastest.
using Neighbours = std::array<std::uint32_t, 27>;

Neighbours neighbours_of(const BlockMap& map, std::uint32_t number) {
  const BlockCoordinates& coordinates = map.coordinates(number);
  Neighbours neighbours;
  std::size_t i = 0;
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const bool is_self = dx == 0 && dy == 0 && dz == 0;
        neighbours[i++] =
            is_self ? number
                    : map.find({coordinates.x + dx, coordinates.y + dy, coordinates.z + dz});
      }
    }
  }
  return neighbours;
}

/// Voxels -1 to 9 of a block on each axis, including its neighbours' voxels.
class Window {
 public:
  static constexpr int kSide = kBlockSide + 3;  ///< with neighbours for cubes and gradients

  Window(const std::vector<Distances>& distances, const Neighbours& neighbours) {
    for (int z = -1; z <= 9; ++z) {
      for (int y = -1; y <= 9; ++y) copy_row(distances, neighbours, y, z);
    }
  }
  [[nodiscard]] std::int16_t operator()(int x, int y, int z) const {
    return values_[index(x, y, z)];
  }

 private:
  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(((z + 1) * kSide + y + 1) * kSide + x + 1);
  }
  void copy_row(const std::vector<Distances>& distances, const Neighbours& neighbours, int y,
                int z) {
    // (v + 8) / 8 is 0, 1, 2 for the block before, this one, the block after.
    const int side = (z + 8) / 8 * 9 + (y + 8) / 8 * 3;
    const int row = (((z + 8) % 8) * kBlockSide + (y + 8) % 8) * kBlockSide;
    const auto copy = [&](int block, int from, int count, int to) {
      std::int16_t* target = values_.data() + index(to, y, z);
      const std::uint32_t number = neighbours[static_cast<std::size_t>(side + block)];
      if (number == BlockHashTable::kNone) {
        std::fill_n(target, count, kUnknown);
      } else {
        std::copy_n(distances[number].data() + row + from, count, target);
      }
    };
    copy(0, 7, 1, -1);
    copy(1, 0, 8, 0);
    copy(2, 0, 2, 8);
  }

  std::array<std::int16_t, kSide * kSide * kSide> values_;
};

/// Bit masks of a block's edges with a vertex and of its cubes with triangles. Edges belong to the
/// block of their lower end.
struct SurfaceMap {
  std::array<std::array<std::uint64_t, 8>, 3> edges{};   ///< by axis and z; bit 8 y + x
  std::array<std::array<std::uint16_t, 8>, 3> before{};  ///< number of vertices before that word
  std::array<std::uint64_t, 8> cubes{};
  std::uint32_t vertices = 0;
  std::uint32_t triangles = 0;
  std::uint32_t first_vertex = 0;
  std::uint32_t first_triangle = 0;
};

/// Calls `visit(at, axis, index)` for each vertex of a block, in the order of their indices from
/// `index` on: it lies on the edge from the voxel `at` of the block along the axis.
template <typename Visit>
void for_each_vertex(const SurfaceMap& surface, const Visit& visit) {
  std::uint32_t next = surface.first_vertex;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int z = 0; z < 8; ++z) {
      for (std::uint64_t left = surface.edges[axis][static_cast<std::size_t>(z)]; left != 0;
           left &= left - 1) {
        const int bit = std::countr_zero(left);
        visit(std::array<int, 3>{bit % 8, bit / 8, z}, axis, next++);
      }
    }
  }
}

/// Signs of the window, one bit per voxel; row and column 0 are voxel -1.
struct SignRows {
  std::array<std::array<std::uint32_t, 10>, 10> inside{};
  std::array<std::array<std::uint32_t, 10>, 10> known{};
  bool has_inside = false;
  bool has_outside = false;

  explicit SignRows(const Window& window) {
    std::uint32_t any_inside = 0;
    std::uint32_t any_outside = 0;
    for (int z = 0; z < 10; ++z) {
      for (int y = 0; y < 10; ++y) {
        std::uint32_t in = 0;
        std::uint32_t is_known = 0;
        for (int x = 0; x < 10; ++x) {
          const std::int16_t value = window(x - 1, y - 1, z - 1);
          in |= static_cast<std::uint32_t>(value < 0) << x;
          is_known |= static_cast<std::uint32_t>(value != kUnknown) << x;
        }
        inside[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = in;
        known[static_cast<std::size_t>(z)][static_cast<std::size_t>(y)] = is_known;
        any_inside |= in & is_known;
        any_outside |= ~in & is_known;
      }
    }
    has_inside = any_inside != 0;
    has_outside = any_outside != 0;
  }

  /// Cubes of a row with all corners known and both signs among them.
  [[nodiscard]] std::uint32_t crossed_cubes(std::size_t y, std::size_t z) const {
    const auto& k0 = known[z];
    const auto& k1 = known[z + 1];
    const std::uint32_t all = k0[y] & k0[y + 1] & k1[y] & k1[y + 1];
    const std::uint32_t in_any =
        inside[z][y] | inside[z][y + 1] | inside[z + 1][y] | inside[z + 1][y + 1];
    const std::uint32_t in_all =
        inside[z][y] & inside[z][y + 1] & inside[z + 1][y] & inside[z + 1][y + 1];
    return (all & (all >> 1)) & (in_any | (in_any >> 1)) & ~(in_all & (in_all >> 1)) & 0x1FFU;
  }

  [[nodiscard]] int cube_case(std::size_t x, std::size_t y, std::size_t z) const {
    std::uint32_t corners = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t pair = (inside[z + (i >> 1)][y + (i & 1)] >> x) & 3U;
      corners |= pair << (2 * i);
    }
    return static_cast<int>(corners);
  }
};

SurfaceMap map_surface(const SignRows& signs) {
  SurfaceMap map;
  if (!signs.has_inside || !signs.has_outside) return map;
  std::array<std::array<std::uint32_t, 9>, 9> cubes{};
  for (std::size_t z = 0; z < 9; ++z) {
    for (std::size_t y = 0; y < 9; ++y) cubes[z][y] = signs.crossed_cubes(y, z);
  }
  for (std::size_t z = 1; z < 9; ++z) {
    for (std::size_t y = 1; y < 9; ++y) {
      // An edge has a vertex where its ends differ and one of the four cubes around it is crossed.
      const std::uint32_t here = signs.inside[z][y];
      const std::uint32_t around_x =
          cubes[z][y] | cubes[z][y - 1] | cubes[z - 1][y] | cubes[z - 1][y - 1];
      const std::uint32_t below_z = cubes[z][y] | cubes[z - 1][y];
      const std::uint32_t below_y = cubes[z][y] | cubes[z][y - 1];
      const std::array<std::uint32_t, 3> crossed = {
          (here ^ (here >> 1)) & around_x,
          (here ^ signs.inside[z][y + 1]) & (below_z | (below_z << 1)),
          (here ^ signs.inside[z + 1][y]) & (below_y | (below_y << 1))};
      const std::size_t shift = 8 * (y - 1);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        map.edges[axis][z - 1] |= static_cast<std::uint64_t>((crossed[axis] >> 1) & 0xFFU) << shift;
      }
      const std::uint32_t own = (cubes[z][y] >> 1) & 0xFFU;
      map.cubes[z - 1] |= static_cast<std::uint64_t>(own) << shift;
      for (std::uint32_t left = own; left != 0; left &= left - 1) {
        const auto x = static_cast<std::size_t>(std::countr_zero(left)) + 1;
        map.triangles +=
            marching_cubes_table()[static_cast<std::size_t>(signs.cube_case(x, y, z))].triangles;
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t z = 0; z < 8; ++z) {
      map.before[axis][z] = static_cast<std::uint16_t>(map.vertices);
      map.vertices += static_cast<std::uint32_t>(std::popcount(map.edges[axis][z]));
    }
  }
  return map;
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
    if (before != kUnknown && after != kUnknown) {
      slope = 0.5F * static_cast<float>(after - before);
    } else if (after != kUnknown) {
      slope = static_cast<float>(after - centre);
    } else if (before != kUnknown) {
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
