// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"

#include <numeric>
#include <vector>

#include "pcavr/base/model/mesh_simplification.hpp"

namespace pcavr {
namespace {

/// Connected components of vertices: union-find with path halving.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t v) {
    while (parent_[v] != v) {
      parent_[v] = parent_[parent_[v]];
      v = parent_[v];
    }
    return v;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    // The lower index is the root, independent of the order.
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

double area_of(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Eigen::Vector3f ab = mesh.vertices[t[1]] - mesh.vertices[t[0]];
  const Eigen::Vector3f ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
  return 0.5 * static_cast<double>(ab.cross(ac).norm());
}

}  // namespace

std::size_t remove_small_components(TriangleMesh& mesh, double min_area) {
  DisjointSets sets(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    sets.unite(t[0], t[1]);
    sets.unite(t[0], t[2]);
  }
  std::vector<double> area(mesh.vertices.size(), 0.0);
  std::vector<bool> has_triangle(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles) {
    area[sets.find(t[0])] += area_of(mesh, t);
    has_triangle[sets.find(t[0])] = true;
  }
  std::size_t dropped = 0;
  for (std::size_t v = 0; v < area.size(); ++v) {
    dropped += has_triangle[v] && area[v] < min_area ? 1 : 0;
  }
  std::erase_if(mesh.triangles, [&](const auto& t) { return area[sets.find(t[0])] < min_area; });
  remove_unused_vertices(mesh);
  return dropped;
}

}  // namespace pcavr
