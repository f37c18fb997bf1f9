// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/link_meshes.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

constexpr int kSides = 32;           ///< of a cylinder: 0.5 % of its radius from the round one
constexpr int kRings = 16;           ///< of a sphere, from pole to pole
constexpr double kRodRadius = 0.04;  ///< [m] about that of the links of small arms

void append(const TriangleMesh& part, TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const std::array<std::uint32_t, 3>& corner : part.triangles) {
    mesh.triangles.push_back({first + corner[0], first + corner[1], first + corner[2]});
  }
}

TriangleMesh box_mesh(const Eigen::Vector3d& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(Eigen::Vector3d((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5,
                                               (i & 4) != 0 ? 0.5 : -0.5)
                                   .cwiseProduct(size)
                                   .cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A mesh around z: rings of kSides vertices at (radius, z), with the first and the last closed by
/// a vertex on the axis.
TriangleMesh turned_mesh(const std::vector<Eigen::Vector2d>& profile, double z_bottom,
                         double z_top) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0.0F, 0.0F, static_cast<float>(z_bottom));
  for (const Eigen::Vector2d& ring : profile) {
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / kSides;
      mesh.vertices.emplace_back(
          Eigen::Vector3d(ring.x() * std::cos(angle), ring.x() * std::sin(angle), ring.y())
              .cast<float>());
    }
  }
  const auto top = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.emplace_back(0.0F, 0.0F, static_cast<float>(z_top));
  const auto at = [](std::size_t ring, int side) {
    return static_cast<std::uint32_t>(1 + ring * kSides + static_cast<std::size_t>(side % kSides));
  };
  for (int side = 0; side < kSides; ++side) {
    mesh.triangles.push_back({0, at(0, side + 1), at(0, side)});
    for (std::size_t ring = 0; ring + 1 < profile.size(); ++ring) {
      mesh.triangles.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side)});
      mesh.triangles.push_back({at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)});
    }
    mesh.triangles.push_back({at(profile.size() - 1, side), at(profile.size() - 1, side + 1), top});
  }
  return mesh;
}

TriangleMesh cylinder_mesh(double radius, double length) {
  return turned_mesh({{radius, -0.5 * length}, {radius, 0.5 * length}}, -0.5 * length,
                     0.5 * length);
}

TriangleMesh sphere_mesh(double radius) {
  std::vector<Eigen::Vector2d> profile;
  for (int ring = 1; ring < kRings; ++ring) {
    const double angle = std::numbers::pi * ring / kRings;
    profile.emplace_back(radius * std::sin(angle), -radius * std::cos(angle));
  }
  return turned_mesh(profile, -radius, radius);
}

/// Empty for a mesh file that was not found.
struct MakeShape {
  Expected<TriangleMesh> operator()(const BoxShape& box) const { return box_mesh(box.size); }
  Expected<TriangleMesh> operator()(const CylinderShape& cylinder) const {
    return cylinder_mesh(cylinder.radius, cylinder.length);
  }
  Expected<TriangleMesh> operator()(const SphereShape& sphere) const {
    return sphere_mesh(sphere.radius);
  }
  Expected<TriangleMesh> operator()(const MeshShape& shape) const {
    if (shape.file.empty()) return TriangleMesh{};
    Expected<TriangleMesh> mesh = read_mesh(shape.file);
    if (!mesh) return mesh;
    for (Eigen::Vector3f& vertex : mesh->vertices) {
      vertex = vertex.cwiseProduct(shape.scale.cast<float>());
    }
    if (shape.scale.prod() < 0.0) {
      for (auto& corner : mesh->triangles) std::swap(corner[1], corner[2]);
    }
    return mesh;
  }
};

Expected<TriangleMesh> mesh_of(const std::vector<RobotShape>& shapes) {
  TriangleMesh mesh_link;
  for (const RobotShape& shape : shapes) {
    const Expected<TriangleMesh> part = std::visit(MakeShape{}, shape.geometry);
    if (!part) return part.error();
    append(transformed(shape.T_link_shape, *part), mesh_link);
  }
  return mesh_link;
}

/// A rod from the origin to a point.
TriangleMesh rod_to(const Eigen::Vector3d& end) {
  const Pose T_link_rod(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), end),
                        0.5 * end);
  return transformed(T_link_rod, cylinder_mesh(kRodRadius, end.norm()));
}

TriangleMesh rods_of(const RobotModel& model, const RobotLink& link) {
  TriangleMesh mesh_link;
  for (const RobotJoint& joint : model.joints) {
    if (joint.parent != link.joint) continue;
    const Eigen::Vector3d p_link = link.T_joint_link.inverse() * joint.T_parent_joint.translation();
    if (p_link.norm() > kRodRadius) append(rod_to(p_link), mesh_link);
  }
  return mesh_link;
}

}  // namespace

Expected<LinkMeshes> link_meshes(const RobotModel& model) {
  LinkMeshes meshes;
  for (const RobotLink& link : model.links) {
    const std::vector<RobotShape>& shapes = link.visuals.empty() ? link.collisions : link.visuals;
    Expected<TriangleMesh> mesh = mesh_of(shapes);
    if (!mesh) return mesh.error();
    if (!shapes.empty() && mesh->triangles.empty()) {
      mesh = rods_of(model, link);
      meshes.warnings.push_back({.message = "no mesh file of link '" + link.name +
                                            "' was found: it is drawn as rods between its joints",
                                 .file = model.file.string(),
                                 .hint = "put the files where the description states them"});
    }
    meshes.of_link.push_back(*std::move(mesh));
  }
  return meshes;
}

std::size_t default_tip(const RobotModel& model) {
  std::vector<std::size_t> depth(model.joints.size(), 1);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (model.joints[i].parent) depth[i] = depth[*model.joints[i].parent] + 1;
  }
  std::size_t tip = 0;
  std::size_t max_depth = 0;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const std::size_t own = model.links[i].joint ? depth[*model.links[i].joint] : 0;
    if (own < max_depth) continue;
    tip = i;
    max_depth = own;
  }
  return tip;
}

}  // namespace pcavr
