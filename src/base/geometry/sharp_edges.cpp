// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/sharp_edges.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

const float kMinSmoothCosine = std::cos(30.0F * static_cast<float>(M_PI) / 180.0F);

/// The normal, with twice the triangle's area as its length.
Eigen::Vector3f area_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

}  // namespace

TriangleMesh with_sharp_edges(const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3f> area_normals;
  std::vector<std::vector<std::size_t>> triangles_at(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    area_normals.push_back(area_normal(mesh, i));
    for (const std::uint32_t vertex : mesh.triangles[i]) triangles_at[vertex].push_back(i);
  }
  TriangleMesh sharp;
  std::vector<std::vector<std::uint32_t>> copies(mesh.vertices.size());
  const auto vertex_with = [&](std::uint32_t vertex, const Eigen::Vector3f& normal) {
    for (const std::uint32_t copy : copies[vertex]) {
      if (sharp.normals[copy].dot(normal) > 0.9999F) return copy;
    }
    copies[vertex].push_back(static_cast<std::uint32_t>(sharp.vertices.size()));
    sharp.vertices.push_back(mesh.vertices[vertex]);
    sharp.normals.push_back(normal);
    if (!mesh.colors.empty()) sharp.colors.push_back(mesh.colors[vertex]);
    return copies[vertex].back();
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3f own = area_normals[i].normalized();
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = mesh.triangles[i][corner];
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (const std::size_t other : triangles_at[vertex]) {
        if (area_normals[other].normalized().dot(own) >= kMinSmoothCosine)
          sum += area_normals[other];
      }
      triangle[corner] = vertex_with(vertex, sum.norm() > 0.0F ? sum.normalized() : own);
    }
    sharp.triangles.push_back(triangle);
  }
  return sharp;
}

}  // namespace pcavr
