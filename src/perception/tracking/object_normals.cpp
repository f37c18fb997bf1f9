// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/object_normals.hpp"

#include <Eigen/Geometry>

namespace pcavr::tracking {
namespace {

/// cos 30 degrees: the usual crease angle of CAD and modelling tools.
constexpr double kCreaseCosine = 0.866;

/// Normal scaled by twice the triangle's area.
Eigen::Vector3d doubled_area(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Eigen::Vector3d origin = mesh.vertices[a].cast<double>();
  return (mesh.vertices[b].cast<double>() - origin).cross(mesh.vertices[c].cast<double>() - origin);
}

}  // namespace

SmoothNormals::SmoothNormals(const TriangleMesh& mesh) : corners_(mesh.triangles.size()) {
  std::vector<Eigen::Vector3d> areas(mesh.triangles.size());
  std::vector<std::vector<std::uint32_t>> around(mesh.vertices.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    areas[i] = doubled_area(mesh, i);
    for (const std::uint32_t vertex : mesh.triangles[i]) around[vertex].push_back(i);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const std::uint32_t neighbour : around[mesh.triangles[i][k]]) {
        const double aligned = areas[i].dot(areas[neighbour]);
        if (aligned >= kCreaseCosine * areas[i].norm() * areas[neighbour].norm()) {
          sum += areas[neighbour];
        }
      }
      corners_[i][k] = sum.normalized().cast<float>();
    }
  }
}

Eigen::Vector3d SmoothNormals::at(const SurfaceQuery::Hit& hit) const {
  const auto& [a, b, c] = corners_[hit.triangle];
  const Eigen::Vector3f normal = (1.0F - hit.u - hit.v) * a + hit.u * b + hit.v * c;
  return normal.cast<double>().normalized();
}

}  // namespace pcavr::tracking
