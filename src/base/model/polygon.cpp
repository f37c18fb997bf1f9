// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/polygon.hpp"

#include <algorithm>

namespace pcavr::model {
namespace {

Eigen::Vector3d vertex_at(const TriangleMesh& mesh, std::uint32_t index) {
  return mesh.vertices[index].cast<double>();
}

/// Newell's normal: correct for polygons that are not convex or not quite planar.
Eigen::Vector3d polygon_normal(const std::vector<std::uint32_t>& corners,
                               const TriangleMesh& mesh) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = vertex_at(mesh, corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal +=
        (vertex_at(mesh, corners[i]) - origin).cross(vertex_at(mesh, corners[i + 1]) - origin);
  }
  return normal;
}

/// Whether the triangle at corner i is an ear: convex, and without another corner inside.
bool is_ear(const std::vector<std::uint32_t>& corners, std::size_t i, const TriangleMesh& mesh,
            const Eigen::Vector3d& normal) {
  const std::size_t n = corners.size();
  const Eigen::Vector3d a = vertex_at(mesh, corners[(i + n - 1) % n]);
  const Eigen::Vector3d b = vertex_at(mesh, corners[i]);
  const Eigen::Vector3d c = vertex_at(mesh, corners[(i + 1) % n]);
  const auto turns_left = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                              const Eigen::Vector3d& r) {
    return normal.dot((q - p).cross(r - p)) > 0.0;
  };
  if (!turns_left(a, b, c)) return false;
  for (std::size_t k = 2; k + 1 < n; ++k) {
    const Eigen::Vector3d p = vertex_at(mesh, corners[(i + k) % n]);
    if (turns_left(a, b, p) && turns_left(b, c, p) && turns_left(c, a, p)) return false;
  }
  return true;
}

}  // namespace

void append_polygon(std::vector<std::uint32_t> corners, TriangleMesh& mesh) {
  if (corners.size() < 3) return;
  const Eigen::Vector3d normal = polygon_normal(corners, mesh);
  while (corners.size() > 3) {
    const std::size_t n = corners.size();
    std::size_t ear = 0;
    while (ear < n && !is_ear(corners, ear, mesh, normal)) ++ear;
    ear %= n;  // a self-intersecting polygon may have no ear: cut any corner
    mesh.triangles.push_back({corners[(ear + n - 1) % n], corners[ear], corners[(ear + 1) % n]});
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  mesh.triangles.push_back({corners[0], corners[1], corners[2]});
}

}  // namespace pcavr::model
