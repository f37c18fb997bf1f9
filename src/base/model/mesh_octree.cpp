// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/model/mesh_octree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "base/model/fixed_simplification.hpp"

namespace pcavr {
namespace {

constexpr int kDeepest = 15;  // cells are numbered in 16 bits

/// A part of a mesh whose vertices are known by their numbers in the whole.
struct Part {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertices;  ///< numbers in the whole
};

/// A tile, its mesh, and the depth of the tree below it.
struct Subtree {
  OctreeTile tile;
  Part part;
  int height = 0;
};

/// Collects triangles from parts; vertices of one number become one.
class PartCollector {
 public:
  /// `number_of` is called with an index of `from`.
  template <typename NumberOf>
  void add(const TriangleMesh& from, const std::array<std::uint32_t, 3>& triangle,
           const NumberOf& number_of) {
    auto& added = part_.mesh.triangles.emplace_back(triangle);
    for (std::uint32_t& v : added) {
      const std::uint32_t number = number_of(v);
      const auto [found, is_new] =
          index_.try_emplace(number, static_cast<std::uint32_t>(part_.vertices.size()));
      if (is_new) {
        part_.vertices.push_back(number);
        part_.mesh.vertices.push_back(from.vertices[v]);
        if (!from.normals.empty()) part_.mesh.normals.push_back(from.normals[v]);
        if (!from.colors.empty()) part_.mesh.colors.push_back(from.colors[v]);
      }
      v = found->second;
    }
  }
  void add(const Part& part) {
    for (const auto& triangle : part.mesh.triangles) {
      add(part.mesh, triangle, [&](std::uint32_t v) { return part.vertices[v]; });
    }
  }
  [[nodiscard]] Part take() { return std::move(part_); }

 private:
  Part part_;
  std::unordered_map<std::uint32_t, std::uint32_t> index_;
};

class OctreeBuilder {
 public:
  using Write = std::function<Expected<void>(const std::string&, const TriangleMesh&)>;
  using Cell = std::array<std::uint16_t, 3>;
  using Triangles = std::vector<std::uint32_t>;

  OctreeBuilder(const TriangleMesh& mesh, const OctreeOptions& options, const Write& write)
      : mesh_(mesh), options_(options), write_(write), box_(bounds(mesh.vertices)) {
    const double extent = double{box_.sizes().maxCoeff()};
    edge_ = options.min_edge;
    while (depth_ < kDeepest && edge_ * (1 << depth_) <= extent) ++depth_;
    // A mesh that is wider than all cells has wider cells.
    edge_ = std::max(edge_, 1.001 * extent / (1 << depth_));
    note_cells();
  }

  Expected<OctreeTile> run() {
    Triangles all(mesh_.triangles.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    Expected<Subtree> root = build("r", depth_, std::move(all));
    if (!root) return root.error();
    return std::move(root->tile);
  }

 private:
  /// The smallest cell of a triangle: that of its first corner.
  [[nodiscard]] Cell cell_of(std::uint32_t triangle) const {
    const Eigen::Vector3d p =
        (mesh_.vertices[mesh_.triangles[triangle][0]] - box_.min()).cast<double>() / edge_;
    Cell cell;
    for (std::size_t i = 0; i < 3; ++i) {
      cell[i] = static_cast<std::uint16_t>(
          std::clamp(p[static_cast<Eigen::Index>(i)], 0.0, static_cast<double>((1 << depth_) - 1)));
    }
    return cell;
  }

  void note_cells() {
    constexpr std::uint16_t kMax = std::numeric_limits<std::uint16_t>::max();
    low_.assign(mesh_.vertices.size(), {kMax, kMax, kMax});
    high_.assign(mesh_.vertices.size(), {0, 0, 0});
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Cell cell = cell_of(i);
      for (const std::uint32_t v : mesh_.triangles[i]) {
        for (std::size_t k = 0; k < 3; ++k) {
          low_[v][k] = std::min(low_[v][k], cell[k]);
          high_[v][k] = std::max(high_[v][k], cell[k]);
        }
      }
    }
  }

  /// Whether the vertex is of several cubes of 2^level smallest cells.
  [[nodiscard]] bool is_common(std::uint32_t v, int level) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (low_[v][k] >> level != high_[v][k] >> level) return true;
    }
    return false;
  }

  [[nodiscard]] std::size_t child_of(std::uint32_t triangle, int level) const {
    const Cell cell = cell_of(triangle);
    std::size_t child = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      child |= static_cast<std::size_t>(cell[k] >> (level - 1) & 1) << k;
    }
    return child;
  }

  Expected<Subtree> build(const std::string& name, int level, Triangles triangles) {
    const bool is_leaf = triangles.size() <= options_.max_triangles || level == 0;
    Expected<Subtree> made = is_leaf ? leaf(triangles) : inner(name, level, std::move(triangles));
    if (!made) return made.error();
    made->tile.name = name;
    made->tile.box.extend(bounds(made->part.mesh.vertices));
    if (const auto written = write_(name, made->part.mesh); !written) return written.error();
    return made;
  }

  [[nodiscard]] Subtree leaf(const Triangles& triangles) const {
    PartCollector collector;
    for (const std::uint32_t i : triangles) {
      collector.add(mesh_, mesh_.triangles[i], [](std::uint32_t v) { return v; });
    }
    return {.tile = {}, .part = collector.take(), .height = 0};
  }

  Expected<Subtree> inner(const std::string& name, int level, Triangles triangles) {
    std::array<Triangles, 8> by_child;
    for (const std::uint32_t i : triangles) by_child[child_of(i, level)].push_back(i);
    triangles = {};
    Subtree node;
    PartCollector collector;
    for (std::size_t i = 0; i < 8; ++i) {
      if (by_child[i].empty()) continue;
      Expected<Subtree> child =
          build(name + static_cast<char>('0' + i), level - 1, std::move(by_child[i]));
      if (!child) return child.error();
      collector.add(child->part);
      node.tile.box.extend(child->tile.box);
      node.tile.error = std::max(node.tile.error, child->tile.error);
      node.height = std::max(node.height, child->height + 1);
      node.tile.children.push_back(std::move(child->tile));
    }
    const double error = options_.error * std::ldexp(1.0, node.height - 1);
    node.part = coarser(collector.take(), level, error);
    // The bound is on the mean over merged planes: single vertices may lie twice as far.
    node.tile.error += 2.0 * error;
    return node;
  }

  /// The part by fewer triangles; vertices that neighbours have too stay.
  [[nodiscard]] Part coarser(Part part, int level, double error) const {
    std::vector<bool> is_fixed;
    for (const std::uint32_t v : part.vertices) is_fixed.push_back(is_common(v, level));
    const TriangleMesh simple = simplified_between(std::move(part.mesh), std::move(is_fixed),
                                                   options_.max_triangles / 2, error);
    PartCollector collector;
    for (const auto& triangle : simple.triangles) {
      collector.add(simple, triangle, [&](std::uint32_t v) { return part.vertices[v]; });
    }
    return collector.take();
  }

  const TriangleMesh& mesh_;
  const OctreeOptions& options_;
  const Write& write_;
  Eigen::AlignedBox3f box_;
  double edge_ = 0.0;  ///< of a smallest cell [m]
  int depth_ = 0;
  std::vector<Cell> low_;  ///< of the cells of each vertex's triangles
  std::vector<Cell> high_;
};

}  // namespace

Expected<OctreeTile> divide_mesh(
    const TriangleMesh& mesh, const OctreeOptions& options,
    const std::function<Expected<void>(const std::string&, const TriangleMesh&)>& write) {
  PCAVR_REQUIRE(!mesh.triangles.empty() && options.min_edge > 0.0 && options.error >= 0.0,
                mesh.triangles.size(), options.min_edge, options.error);
  return OctreeBuilder(mesh, options, write).run();
}

}  // namespace pcavr
