// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/mesh_repair.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace pcavr::model {
namespace {

constexpr std::uint32_t kUnused = ~std::uint32_t{0};

/// Everything that tells two vertices apart, ordered.
class VertexOrder {
 public:
  explicit VertexOrder(const TriangleMesh& mesh) : mesh_(mesh) {}

  [[nodiscard]] int compare(std::uint32_t i, std::uint32_t j) const {
    if (const int order = compare(mesh_.vertices[i], mesh_.vertices[j])) return order;
    if (!mesh_.normals.empty()) {
      if (const int order = compare(mesh_.normals[i], mesh_.normals[j])) return order;
    }
    if (mesh_.colors.empty()) return 0;
    const auto channels = [this](std::uint32_t k) {
      return std::make_tuple(mesh_.colors[k].r, mesh_.colors[k].g, mesh_.colors[k].b);
    };
    return channels(i) < channels(j) ? -1 : (channels(j) < channels(i) ? 1 : 0);
  }

 private:
  static int compare(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    for (int axis = 0; axis < 3; ++axis) {
      if (a[axis] < b[axis]) return -1;
      if (b[axis] < a[axis]) return 1;
    }
    return 0;
  }
  const TriangleMesh& mesh_;
};

/// For each vertex, the first one that is equal to it.
std::vector<std::uint32_t> first_equals(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> sorted(mesh.vertices.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  const VertexOrder order(mesh);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t i, std::uint32_t j) {
    const int comparison = order.compare(i, j);
    return comparison != 0 ? comparison < 0 : i < j;
  });
  std::vector<std::uint32_t> firsts(mesh.vertices.size());
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool is_new = k == 0 || order.compare(sorted[k - 1], sorted[k]) != 0;
    firsts[sorted[k]] = is_new ? sorted[k] : firsts[sorted[k - 1]];
  }
  return firsts;
}

Eigen::Vector3d corner(const TriangleMesh& mesh, std::uint32_t index) {
  return mesh.vertices[index].cast<double>();
}

}  // namespace

TriangleMesh join_equal_vertices(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> firsts = first_equals(mesh);
  std::vector<std::uint32_t> places(mesh.vertices.size(), kUnused);
  TriangleMesh joined;
  joined.triangles.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    std::array<std::uint32_t, 3> moved{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t source = firsts[triangle[k]];
      if (places[source] == kUnused) {
        places[source] = static_cast<std::uint32_t>(joined.vertices.size());
        joined.vertices.push_back(mesh.vertices[source]);
        if (!mesh.normals.empty()) joined.normals.push_back(mesh.normals[source]);
        if (!mesh.colors.empty()) joined.colors.push_back(mesh.colors[source]);
      }
      moved[k] = places[source];
    }
    joined.triangles.push_back(moved);
  }
  return joined;
}

TriangleMesh without_empty_triangles(TriangleMesh mesh) {
  std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    const Eigen::Vector3d origin = corner(mesh, a);
    const Eigen::Vector3d doubled_area = (corner(mesh, b) - origin).cross(corner(mesh, c) - origin);
    return !(doubled_area.squaredNorm() > 0.0);
  });
  return mesh;
}

OpenEdges find_open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangle[k];
      const std::uint32_t to = triangle[(k + 1) % 3];
      if (from < to) ++balance[{from, to}];
      if (to < from) --balance[{to, from}];
    }
  }
  OpenEdges open;
  for (const auto& [edge, count] : balance) {
    if (count == 0) continue;
    if (open.count == 0) {
      open.somewhere = 0.5F * (mesh.vertices[edge.first] + mesh.vertices[edge.second]);
    }
    ++open.count;
  }
  return open;
}

MassProperties mass_properties(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  // From the middle of the mesh, the tetrahedra cancel least.
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
