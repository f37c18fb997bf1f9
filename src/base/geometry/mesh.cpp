// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/geometry/mesh.hpp"

#include <cmath>

namespace pcavr {
namespace {

struct Corners {
  Eigen::Vector3d a, b, c;
  [[nodiscard]] Eigen::Vector3d doubled_area_normal() const { return (b - a).cross(c - a); }
};

Corners corners_of(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return {mesh.vertices[triangle[0]].cast<double>(), mesh.vertices[triangle[1]].cast<double>(),
          mesh.vertices[triangle[2]].cast<double>()};
}

}  // namespace

Eigen::AlignedBox3f bounds(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  return box;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& triangle : mesh.triangles) {
    area += 0.5 * corners_of(mesh, triangle).doubled_area_normal().norm();
  }
  return area;
}

double signed_volume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Corners corner = corners_of(mesh, triangle);
    volume += corner.a.dot(corner.b.cross(corner.c)) / 6.0;
  }
  return volume;
}

TriangleMesh transformed(const Pose& T_a_b, const TriangleMesh& mesh_b) {
  TriangleMesh mesh_a = mesh_b;
  for (Eigen::Vector3f& vertex : mesh_a.vertices) {
    vertex = (T_a_b * vertex.cast<double>().eval()).cast<float>();
  }
  const Eigen::Matrix3f R_a_b = T_a_b.rotation_matrix().cast<float>();
  for (Eigen::Vector3f& normal : mesh_a.normals) normal = R_a_b * normal;
  return mesh_a;
}

void compute_vertex_normals(TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> sums(mesh.vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d normal = corners_of(mesh, triangle).doubled_area_normal();
    for (const std::uint32_t vertex : triangle) sums[vertex] += normal;
  }
  mesh.normals.resize(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double norm = sums[i].norm();
    mesh.normals[i] =
        norm > 0.0 ? (sums[i] / norm).cast<float>().eval() : Eigen::Vector3f::UnitZ().eval();
  }
}

}  // namespace pcavr
