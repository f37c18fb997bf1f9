// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/mesh_repair.hpp"

#include <algorithm>
#include <numeric>

#include "base/model/vertex_table.hpp"

namespace pcavr::model {
namespace {

constexpr std::uint32_t kUnused = ~std::uint32_t{0};

/// Compares vertices by position, normal and colour.
class VertexComparison {
 public:
  explicit VertexComparison(const TriangleMesh& mesh) : mesh_(mesh) {}

  [[nodiscard]] bool is_same(std::uint32_t i, std::uint32_t j) const {
    if (!is_identical(mesh_.vertices[i], mesh_.vertices[j])) return false;
    if (!mesh_.normals.empty() && !is_identical(mesh_.normals[i], mesh_.normals[j])) return false;
    return mesh_.colors.empty() || mesh_.colors[i] == mesh_.colors[j];
  }
  [[nodiscard]] std::uint64_t hash(std::uint32_t i) const {
    std::uint64_t mixed = hash_of(mesh_.vertices[i]);
    if (!mesh_.normals.empty()) mixed = hash_of(mesh_.normals[i], mixed);
    if (!mesh_.colors.empty()) {
      const Rgb8& c = mesh_.colors[i];
      mixed = hash_of(Eigen::Vector3f(c.r, c.g, c.b), mixed);
    }
    return mixed;
  }

 private:
  const TriangleMesh& mesh_;
};

/// The index of the first equal vertex, for each vertex.
std::vector<std::uint32_t> first_equals(const TriangleMesh& mesh) {
  const VertexComparison comparison(mesh);
  VertexTable table(mesh.vertices.size());
  std::vector<std::uint32_t> firsts(mesh.vertices.size());
  for (std::uint32_t i = 0; i < firsts.size(); ++i) {
    firsts[i] = table.find_or_insert(
        comparison.hash(i), i, [&](std::uint32_t j) { return comparison.is_same(i, j); },
        [&](std::uint32_t j) { return comparison.hash(j); });
  }
  return firsts;
}

Eigen::Vector3d corner(const TriangleMesh& mesh, std::uint32_t index) {
  return mesh.vertices[index].cast<double>();
}

/// take(low, high) for each edge that is not used equally often in both directions.
template <typename Take>
void for_each_open_edge(const TriangleMesh& mesh, const Take& take) {
  // Edges bucketed by their lower vertex: index of its first edge in `edges`, which hold the upper
  // vertex and the direction.
  std::vector<std::size_t> first(mesh.vertices.size() + 1, 0);
  const auto for_each_edge = [&](const auto& use) {
    for (const auto& triangle : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = triangle[k];
        const std::uint32_t to = triangle[(k + 1) % 3];
        if (from != to) use(std::min(from, to), std::max(from, to), from < to);
      }
    }
  };
  for_each_edge([&](std::uint32_t low, std::uint32_t, bool) { ++first[low + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint64_t> edges(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for_each_edge([&](std::uint32_t low, std::uint32_t high, bool is_upward) {
    edges[next[low]++] = std::uint64_t{high} << 1U | (is_upward ? 1U : 0U);
  });
  for (std::size_t low = 0; low + 1 < first.size(); ++low) {
    const auto begin = edges.begin() + static_cast<std::ptrdiff_t>(first[low]);
    const auto end = edges.begin() + static_cast<std::ptrdiff_t>(first[low + 1]);
    std::sort(begin, end);
    for (auto edge = begin; edge != end;) {
      const std::uint64_t high = *edge >> 1U;
      std::ptrdiff_t balance = 0;
      for (; edge != end && *edge >> 1U == high; ++edge) balance += (*edge & 1U) != 0U ? 1 : -1;
      if (balance != 0) take(low, static_cast<std::size_t>(high));
    }
  }
}

}  // namespace

TriangleMesh weld_vertices(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> firsts = first_equals(mesh);
  std::vector<std::uint32_t> new_indices(mesh.vertices.size(), kUnused);
  TriangleMesh welded;
  welded.triangles.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t source = firsts[triangle[k]];
      if (new_indices[source] == kUnused) {
        new_indices[source] = static_cast<std::uint32_t>(welded.vertices.size());
        welded.vertices.push_back(mesh.vertices[source]);
        if (!mesh.normals.empty()) welded.normals.push_back(mesh.normals[source]);
        if (!mesh.colors.empty()) welded.colors.push_back(mesh.colors[source]);
      }
      corners[k] = new_indices[source];
    }
    welded.triangles.push_back(corners);
  }
  return welded;
}

TriangleMesh without_degenerate_triangles(TriangleMesh mesh) {
  std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    const Eigen::Vector3d origin = corner(mesh, a);
    const Eigen::Vector3d doubled_area = (corner(mesh, b) - origin).cross(corner(mesh, c) - origin);
    return !(doubled_area.squaredNorm() > 0.0);
  });
  return mesh;
}

OpenEdges find_open_edges(const TriangleMesh& mesh) {
  OpenEdges open;
  for_each_open_edge(mesh, [&](std::size_t low, std::size_t high) {
    if (open.count == 0) open.location = 0.5F * (mesh.vertices[low] + mesh.vertices[high]);
    ++open.count;
  });
  return open;
}

std::vector<bool> vertices_of_open_edges(const TriangleMesh& mesh) {
  std::vector<bool> are_open(mesh.vertices.size());
  for_each_open_edge(mesh, [&](std::size_t low, std::size_t high) {
    are_open[low] = true;
    are_open[high] = true;
  });
  return are_open;
}

MassProperties mass_properties(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  // Relative to the centre of the mesh, cancellation errors are smallest.
  const Eigen::Vector3d middle = bounds(mesh.vertices).center().cast<double>();
  MassProperties sum;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = corner(mesh, triangle[0]) - middle;
    const Eigen::Vector3d b = corner(mesh, triangle[1]) - middle;
    const Eigen::Vector3d c = corner(mesh, triangle[2]) - middle;
    const double volume = a.dot(b.cross(c)) / 6.0;
    sum.volume += volume;
    sum.centroid += volume / 4.0 * (a + b + c);
  }
  if (sum.volume != 0.0) sum.centroid /= sum.volume;
  sum.centroid += middle;
  return sum;
}

}  // namespace pcavr::model
