// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/shapes.hpp"

#include <cmath>
#include <numbers>

#include "pcavr/base/core/check.hpp"

namespace pcavr::simulation {
namespace {

using Index = std::uint32_t;

std::uint32_t next_facet(const Surface& surface) {
  return surface.facet.empty() ? 0U : surface.facet.back() + 1;
}

Index add_vertex(Surface& surface, const Pose& T_body_shape, const Eigen::Vector3d& p_shape) {
  const Eigen::Vector3d p_body = T_body_shape * p_shape;
  surface.mesh.vertices.push_back(p_body.cast<float>());
  return static_cast<Index>(surface.mesh.vertices.size() - 1);
}

void add_triangle(Surface& surface, const std::array<Index, 3>& corners,
                  const std::array<Eigen::Vector3f, 3>& normals, std::uint32_t facet,
                  std::uint16_t material) {
  const auto& vertices = surface.mesh.vertices;
  surface.normal.push_back((vertices[corners[1]] - vertices[corners[0]])
                               .cross(vertices[corners[2]] - vertices[corners[0]])
                               .normalized());
  surface.mesh.triangles.push_back(corners);
  surface.corner_normals.push_back(normals);
  surface.facet.push_back(facet);
  surface.material.push_back(material);
}

/// A planar convex face, as a triangle fan.
void add_face(Surface& surface, const std::vector<Index>& loop, std::uint16_t material) {
  const auto& vertices = surface.mesh.vertices;
  const Eigen::Vector3f normal = (vertices[loop[1]] - vertices[loop[0]])
                                     .cross(vertices[loop[2]] - vertices[loop[0]])
                                     .normalized();
  const std::uint32_t facet = next_facet(surface);
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    add_triangle(surface, {loop[0], loop[i], loop[i + 1]}, {normal, normal, normal}, facet,
                 material);
  }
}

/// Outward normals (r, z) of a profile's edges at both of their ends, and the facet of each edge.
struct ProfileShading {
  std::vector<Eigen::Vector2d> at_start, at_end;
  std::vector<std::uint32_t> facet;
};

ProfileShading shade_profile(const std::vector<Eigen::Vector2d>& profile, std::uint32_t facet) {
  const std::size_t edges = profile.size() - 1;
  ProfileShading shading;
  for (std::size_t i = 0; i < edges; ++i) {
    const Eigen::Vector2d along = (profile[i + 1] - profile[i]).normalized();
    shading.at_start.emplace_back(along.y(), -along.x());
  }
  shading.at_end = shading.at_start;
  shading.facet.assign(edges, facet);
  const double smooth = std::cos(40.0 * std::numbers::pi / 180.0);
  const std::vector<Eigen::Vector2d> flat = shading.at_start;
  for (std::size_t i = 1; i < edges; ++i) {
    const bool is_smooth = flat[i - 1].dot(flat[i]) > smooth;
    shading.facet[i] = shading.facet[i - 1] + (is_smooth ? 0U : 1U);
    if (!is_smooth) continue;
    const Eigen::Vector2d mean = (flat[i - 1] + flat[i]).normalized();
    shading.at_end[i - 1] = mean;
    shading.at_start[i] = mean;
  }
  return shading;
}

Eigen::Vector2d direction_of(std::size_t k, std::size_t segments) {
  const double turn = static_cast<double>(k % segments) / static_cast<double>(segments);
  return {std::cos(2.0 * std::numbers::pi * turn), std::sin(2.0 * std::numbers::pi * turn)};
}

/// The vertices of one point of a profile: a ring, or one vertex where it lies on the axis.
std::vector<Index> add_ring(Surface& surface, const Eigen::Vector2d& point, std::size_t segments,
                            const Pose& T_body_shape) {
  std::vector<Index> ring;
  for (std::size_t k = 0; k < (point.x() > 0.0 ? segments : 1); ++k) {
    const Eigen::Vector2d d = direction_of(k, segments) * point.x();
    ring.push_back(add_vertex(surface, T_body_shape, {d.x(), d.y(), point.y()}));
  }
  return ring;
}

}  // namespace

void add_revolution(Surface& surface, const std::vector<Eigen::Vector2d>& profile, int segments,
                    const Pose& T_body_shape, std::uint16_t material) {
  PCAVR_REQUIRE(profile.size() >= 3 && segments >= 3, profile.size(), segments);
  const ProfileShading shading = shade_profile(profile, next_facet(surface));
  const auto count = static_cast<std::size_t>(segments);
  const auto normal = [&](const Eigen::Vector2d& rz, std::size_t k) -> Eigen::Vector3f {
    const Eigen::Vector2d d = direction_of(k, count) * rz.x();
    return (T_body_shape.rotation() * Eigen::Vector3d(d.x(), d.y(), rz.y())).cast<float>();
  };
  const auto at = [](const std::vector<Index>& ring, std::size_t k) {
    return ring[k % ring.size()];
  };
  std::vector<Index> below = add_ring(surface, profile.front(), count, T_body_shape);
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const std::vector<Index> above = add_ring(surface, profile[i + 1], count, T_body_shape);
    const Eigen::Vector2d& low = shading.at_start[i];
    const Eigen::Vector2d& high = shading.at_end[i];
    const std::uint32_t facet = shading.facet[i];
    for (std::size_t k = 0; k < count; ++k) {
      if (below.size() > 1) {
        add_triangle(surface, {at(below, k), at(below, k + 1), at(above, k + 1)},
                     {normal(low, k), normal(low, k + 1), normal(high, k + 1)}, facet, material);
      }
      if (above.size() > 1) {
        add_triangle(surface, {at(below, k), at(above, k + 1), at(above, k)},
                     {normal(low, k), normal(high, k + 1), normal(high, k)}, facet, material);
      }
    }
    below = above;
  }
}

void add_prism(Surface& surface, const std::vector<Eigen::Vector2d>& polygon, double bottom,
               double top, const Pose& T_body_shape, std::uint16_t material) {
  PCAVR_REQUIRE(polygon.size() >= 3, polygon.size());
  std::vector<Index> low;
  std::vector<Index> high;
  for (const Eigen::Vector2d& p : polygon) {
    low.push_back(add_vertex(surface, T_body_shape, {p.x(), p.y(), bottom}));
    high.push_back(add_vertex(surface, T_body_shape, {p.x(), p.y(), top}));
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::size_t j = (i + 1) % polygon.size();
    add_face(surface, {low[i], low[j], high[j], high[i]}, material);
  }
  add_face(surface, high, material);
  add_face(surface, {low.rbegin(), low.rend()}, material);
}

void add_box(Surface& surface, const Eigen::Vector3d& half_extents, const Pose& T_body_shape,
             std::uint16_t material) {
  const double x = half_extents.x();
  const double y = half_extents.y();
  add_prism(surface, {{-x, -y}, {x, -y}, {x, y}, {-x, y}}, -half_extents.z(), half_extents.z(),
            T_body_shape, material);
}

void add_slotted_block(Surface& surface, const Eigen::Vector3d& half_extents, double half_slot,
                       double floor, std::uint16_t material) {
  const double a = half_extents.x();
  const double h = half_extents.z();
  const double s = half_slot;
  PCAVR_REQUIRE(s > 0.0 && s < a && floor > -h && floor < h, s, floor);
  // Its outline in x and z, counter-clockwise seen from -y.
  const std::vector<Eigen::Vector2d> outline{{-a, -h},   {a, -h},     {a, h},  {s, h},
                                             {s, floor}, {-s, floor}, {-s, h}, {-a, h}};
  std::vector<Index> front;
  std::vector<Index> back;
  for (const Eigen::Vector2d& p : outline) {
    front.push_back(add_vertex(surface, Pose(), {p.x(), -half_extents.y(), p.y()}));
    back.push_back(add_vertex(surface, Pose(), {p.x(), half_extents.y(), p.y()}));
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t j = (i + 1) % outline.size();
    add_face(surface, {front[i], back[i], back[j], front[j]}, material);
  }
  // The end faces: one piece under the slot and one per wall, without additional vertices.
  for (const std::array<std::size_t, 4>& c :
       {std::array<std::size_t, 4>{0, 1, 4, 5}, {1, 2, 3, 4}, {7, 0, 5, 6}}) {
    add_face(surface, {front[c[0]], front[c[1]], front[c[2]], front[c[3]]}, material);
    add_face(surface, {back[c[3]], back[c[2]], back[c[1]], back[c[0]]}, material);
  }
}

void add_block_with_hole(Surface& surface, const Eigen::Vector3d& half_extents,
                         const ObliqueHole& hole, std::uint16_t material) {
  const double h = half_extents.z();
  PCAVR_REQUIRE(hole.floor > -h && hole.floor < h, hole.floor);
  const auto ring = [&](const Eigen::Vector2d& middle, const Eigen::Vector2d& half, double z) {
    std::array<Index, 4> corners{};
    constexpr int kSigns[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (std::size_t i = 0; i < 4; ++i) {
      corners[i] = add_vertex(
          surface, Pose(),
          {middle.x() + kSigns[i][0] * half.x(), middle.y() + kSigns[i][1] * half.y(), z});
    }
    return corners;
  };
  const Eigen::Vector2d outer = half_extents.head<2>();
  const auto bottom = ring(Eigen::Vector2d::Zero(), outer, -h);
  const auto top = ring(Eigen::Vector2d::Zero(), outer, h);
  const auto mouth = ring(hole.mouth, hole.half_extents, h);
  const auto floor = ring(hole.bottom, hole.half_extents, hole.floor);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t j = (i + 1) % 4;
    add_face(surface, {bottom[i], bottom[j], top[j], top[i]}, material);
    add_face(surface, {top[i], top[j], mouth[j], mouth[i]}, material);
    add_face(surface, {mouth[i], mouth[j], floor[j], floor[i]}, material);
  }
  add_face(surface, {floor.begin(), floor.end()}, material);
  add_face(surface, {bottom.rbegin(), bottom.rend()}, material);
}

void add_mesh(Surface& surface, const TriangleMesh& mesh, std::uint16_t material) {
  const auto first = static_cast<Index>(surface.mesh.vertices.size());
  surface.mesh.vertices.insert(surface.mesh.vertices.end(), mesh.vertices.begin(),
                               mesh.vertices.end());
  const std::uint32_t facet = next_facet(surface);
  for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
    const std::array<Index, 3> corners{first + triangle[0], first + triangle[1],
                                       first + triangle[2]};
    const Eigen::Vector3f& a = surface.mesh.vertices[corners[0]];
    const Eigen::Vector3f normal = (surface.mesh.vertices[corners[1]] - a)
                                       .cross(surface.mesh.vertices[corners[2]] - a)
                                       .normalized();
    add_triangle(surface, corners, {normal, normal, normal}, facet, material);
  }
}

std::vector<Eigen::Vector2d> cylinder_profile(double radius, double height) {
  return {{0.0, 0.0}, {radius, 0.0}, {radius, height}, {0.0, height}};
}

std::vector<Eigen::Vector2d> sphere_profile(double radius) {
  constexpr int kSteps = 20;
  std::vector<Eigen::Vector2d> profile{{0.0, 0.0}};
  for (int i = 1; i < kSteps; ++i) {
    const double angle = std::numbers::pi * i / kSteps;
    profile.emplace_back(radius * std::sin(angle), radius * (1.0 - std::cos(angle)));
  }
  profile.emplace_back(0.0, 2.0 * radius);
  return profile;
}

std::vector<Eigen::Vector2d> cup_profile(double radius, double height, double wall) {
  const double base = 0.82 * radius;  // a mug narrows towards its foot
  return {{0.0, 0.0},          {base, 0.0}, {radius, height}, {radius - wall, height},
          {base - wall, wall}, {0.0, wall}};
}

}  // namespace pcavr::simulation
