// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/model/mesh_simplification.hpp"

#include "base/model/fixed_simplification.hpp"

namespace pcavr {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;
/// Triangles of all parts together, relative to the target: so many that the borders of the parts,
/// which are left as they were, do not decide what the last step can reach.
constexpr double kPartShare = 4.0;

using Cube = std::array<int, 3>;

/// The triangles of each cube, by their first corners.
std::map<Cube, std::vector<std::uint32_t>> triangles_by_cube(const TriangleMesh& mesh,
                                                             double edge) {
  std::map<Cube, std::vector<std::uint32_t>> cubes;
  Cube last{};
  std::vector<std::uint32_t>* triangles = nullptr;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3d p = mesh.vertices[mesh.triangles[i][0]].cast<double>() / edge;
    const Cube cube{static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y())),
                    static_cast<int>(std::floor(p.z()))};
    if (triangles == nullptr || cube != last) triangles = &cubes[cube];
    last = cube;
    triangles->push_back(i);
  }
  return cubes;
}

/// Simplifies one cube's triangles after the other, and joins them by their common vertices.
class PartSimplifier {
 public:
  explicit PartSimplifier(const TriangleMesh& mesh)
      : mesh_(mesh), part_of_(mesh.vertices.size(), kNone), local_(mesh.vertices.size(), kNone) {}

  /// Call for all parts before the first add().
  void note(const std::vector<std::uint32_t>& triangles, std::uint32_t part) {
    for (const std::uint32_t i : triangles) {
      for (const std::uint32_t v : mesh_.triangles[i]) {
        if (part_of_[v] == kNone) part_of_[v] = part;
        if (part_of_[v] != part) common_.emplace(v, kNone);
      }
    }
  }

  void add(const std::vector<std::uint32_t>& triangles, std::size_t target, double max_error) {
    std::vector<std::uint32_t> vertices;  // of the mesh, by their numbers in the part
    TriangleMesh part;
    for (const std::uint32_t i : triangles) {
      auto& triangle = part.triangles.emplace_back(mesh_.triangles[i]);
      for (std::uint32_t& v : triangle) v = local_vertex(v, vertices, part);
    }
    for (const std::uint32_t v : vertices) local_[v] = kNone;
    std::vector<bool> is_fixed(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) is_fixed[i] = common_.contains(vertices[i]);
    append(simplified_between(std::move(part), std::move(is_fixed), target, max_error), vertices);
  }

  [[nodiscard]] TriangleMesh take() { return std::move(result_); }

 private:
  std::uint32_t local_vertex(std::uint32_t v, std::vector<std::uint32_t>& vertices,
                             TriangleMesh& part) {
    if (local_[v] != kNone) return local_[v];
    local_[v] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(v);
    copy_vertex(mesh_, v, part);
    return local_[v];
  }

  static std::uint32_t copy_vertex(const TriangleMesh& from, std::uint32_t v, TriangleMesh& to) {
    to.vertices.push_back(from.vertices[v]);
    if (!from.normals.empty()) to.normals.push_back(from.normals[v]);
    if (!from.colors.empty()) to.colors.push_back(from.colors[v]);
    return static_cast<std::uint32_t>(to.vertices.size() - 1);
  }

  void append(const TriangleMesh& part, const std::vector<std::uint32_t>& vertices) {
    std::vector<std::uint32_t> number(part.vertices.size(), kNone);
    for (const auto& triangle : part.triangles) {
      auto& added = result_.triangles.emplace_back(triangle);
      for (std::uint32_t& v : added) {
        const auto common = common_.find(vertices[v]);
        std::uint32_t& known = common != common_.end() ? common->second : number[v];
        if (known == kNone) known = copy_vertex(part, v, result_);
        v = known;
      }
    }
  }

  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> part_of_;  ///< by vertex
  std::vector<std::uint32_t> local_;    ///< by vertex: its number in the part that is added
  std::map<std::uint32_t, std::uint32_t> common_;  ///< of several parts: its number in the result
  TriangleMesh result_;
};

}  // namespace

TriangleMesh simplified_in_parts(const TriangleMesh& mesh, std::size_t target_triangles,
                                 double max_error, double part_edge) {
  PCAVR_REQUIRE(max_error >= 0.0 && part_edge > 0.0, max_error, part_edge);
  if (mesh.triangles.size() <= target_triangles) return mesh;
  const auto cubes = triangles_by_cube(mesh, part_edge);
  PartSimplifier parts(mesh);
  std::uint32_t number = 0;
  for (const auto& [cube, triangles] : cubes) parts.note(triangles, number++);
  const double kept = std::min(1.0, kPartShare * static_cast<double>(target_triangles) /
                                        static_cast<double>(mesh.triangles.size()));
  for (const auto& [cube, triangles] : cubes) {
    const auto target = static_cast<std::size_t>(kept * static_cast<double>(triangles.size()));
    parts.add(triangles, target, 0.5 * max_error);
  }
  return simplified(parts.take(), target_triangles, 0.5 * max_error);
}

}  // namespace pcavr
