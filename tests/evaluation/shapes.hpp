// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

/// A rectangle in the plane z = height, facing up.
inline TriangleMesh a_plane(float x_from, float x_to, float y_from, float y_to, float height) {
  TriangleMesh mesh;
  mesh.vertices = {{x_from, y_from, height},
                   {x_to, y_from, height},
                   {x_to, y_to, height},
                   {x_from, y_to, height}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A closed box around the origin, with outward winding.
inline TriangleMesh a_box(const Eigen::Vector3f& size) {
  TriangleMesh mesh;
  for (const float z : {-0.5F, 0.5F}) {
    for (const float y : {-0.5F, 0.5F}) {
      for (const float x : {-0.5F, 0.5F}) {
        mesh.vertices.push_back(size.cwiseProduct(Eigen::Vector3f(x, y, z)));
      }
    }
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Both meshes in one.
inline TriangleMesh merged(TriangleMesh a, const TriangleMesh& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& triangle : b.triangles) {
    a.triangles.push_back({triangle[0] + offset, triangle[1] + offset, triangle[2] + offset});
  }
  return a;
}

}  // namespace pcavr
