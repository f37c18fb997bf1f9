// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/prediction/closest_surface.hpp"

#include "prediction/worlds.hpp"

/// Scanned clutter in the way of a pushed box, and the deepest scan point inside of it.
namespace pcavr::test {

constexpr double kScanSpacing = 0.004;  ///< [m] between the vertices of the scan

/// Vertices of a surface p(u, v), u and v in [0, 1]; the front is on the left of u cross v.
inline void add_patch(TriangleMesh& mesh, double size_u, double size_v,
                      const std::function<Eigen::Vector3d(double, double)>& at) {
  const int n = std::max(1, static_cast<int>(std::ceil(size_u / kScanSpacing)));
  const int m = std::max(1, static_cast<int>(std::ceil(size_v / kScanSpacing)));
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= m; ++j) {
      mesh.vertices.push_back(
          at(static_cast<double>(i) / n, static_cast<double>(j) / m).cast<float>());
    }
  }
  const auto row = static_cast<std::uint32_t>(m + 1);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(n); ++i) {
    for (std::uint32_t j = 0; j + 1 < row; ++j) {
      const std::uint32_t a = first + i * row + j;
      mesh.triangles.push_back({a, a + row, a + 1});
      mesh.triangles.push_back({a + 1, a + row, a + row + 1});
    }
  }
}

inline void add_wall(TriangleMesh& mesh, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                     double height) {
  add_patch(mesh, (to - from).norm(), height, [=](double u, double v) -> Eigen::Vector3d {
    const Eigen::Vector2d p = from + u * (to - from);
    return {p.x(), p.y(), v * height};
  });
}

/// Upright, around the corners in this order: counter-clockwise, its front is outside.
inline void add_prism(TriangleMesh& mesh, const std::vector<Eigen::Vector2d>& corners,
                      double height) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    add_wall(mesh, corners[i], corners[(i + 1) % corners.size()], height);
  }
}

/// An upright cylinder's wall between two angles; `side` 1 faces outward, -1 inward.
inline void add_cylinder(TriangleMesh& mesh, const Eigen::Vector2d& centre, double radius,
                         double height, double from, double to, double side) {
  add_patch(mesh, radius * (to - from), height, [=](double u, double v) -> Eigen::Vector3d {
    const double angle = side > 0.0 ? from + u * (to - from) : to - u * (to - from);
    return {centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle),
            v * height};
  });
}

inline std::vector<Eigen::Vector2d> turned_rectangle(const Eigen::Vector2d& centre,
                                                     const Eigen::Vector2d& sides, double yaw) {
  std::vector<Eigen::Vector2d> corners;
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    corners.push_back(centre +
                      Eigen::Rotation2Dd(yaw) * Eigen::Vector2d(x * sides.x(), y * sides.y()));
  }
  return corners;
}

constexpr std::array<std::string_view, 8> kClutter{
    "cup", "cylinder", "box", "plate", "corner", "ball", "peg", "cup seen from behind"};

/// A clutter object whose front is near x = 0.1, around y = 0.
inline TriangleMesh clutter_of(std::string_view shape) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  TriangleMesh mesh;
  if (shape == "cup") {  // walls of 2 mm
    add_cylinder(mesh, {0.14, 0.0}, 0.04, 0.1, 0.0, kTurn, 1.0);
    add_cylinder(mesh, {0.14, 0.0}, 0.038, 0.1, 0.0, kTurn, -1.0);
  } else if (shape == "cup seen from behind") {
    add_cylinder(mesh, {0.14, 0.0}, 0.04, 0.1, -0.25 * kTurn, 0.25 * kTurn, 1.0);
  } else if (shape == "cylinder") {
    add_cylinder(mesh, {0.16, 0.0}, 0.06, 0.15, 0.0, kTurn, 1.0);
  } else if (shape == "box") {
    add_prism(mesh, turned_rectangle({0.15, 0.0}, {0.08, 0.08}, 0.6), 0.1);
  } else if (shape == "plate") {  // 2 mm thick, and askew
    add_prism(mesh, turned_rectangle({0.13, 0.0}, {0.002, 0.2}, 0.3), 0.1);
  } else if (shape == "corner") {  // concave
    add_wall(mesh, {0.16, -0.12}, {0.1, -0.02}, 0.1);
    add_wall(mesh, {0.14, 0.0}, {0.16, -0.12}, 0.1);
    add_wall(mesh, {0.09, 0.1}, {0.14, 0.0}, 0.1);
  } else if (shape == "ball") {
    add_patch(mesh, kTurn * 0.045, 0.5 * kTurn * 0.045, [](double u, double v) -> Eigen::Vector3d {
      const double azimuth = u * 2.0 * std::numbers::pi;
      const double polar = std::numbers::pi * (1.0 - v);
      return Eigen::Vector3d(0.15, 0.0, 0.045) +
             0.045 * Eigen::Vector3d(std::sin(polar) * std::cos(azimuth),
                                     std::sin(polar) * std::sin(azimuth), std::cos(polar));
    });
  } else {  // peg
    add_cylinder(mesh, {0.106, 0.0}, 0.006, 0.1, 0.0, kTurn, 1.0);
  }
  return mesh;
}

struct ScanPush {
  std::string_view shape = "cup";
  double speed = 0.15;      ///< [m/s] of the tip along x
  double offset = 0.0;      ///< [m] of the tip from the box's middle, along y
  double noise = 0.0;       ///< [m] max. displacement of a scan point along its normal
  double clutter_y = 0.02;  ///< [m] of the clutter
  /// of the box on its support [kg], [N]
  double mass = 0.5;
  double limit = 3.0;
};

/// The clutter on a scanned table.
inline TriangleMesh scan_of(const ScanPush& push) {
  TriangleMesh mesh = clutter_of(push.shape);
  for (auto& v : mesh.vertices) v.y() += static_cast<float>(push.clutter_y);
  add_patch(mesh, 0.6, 0.4, [](double u, double v) -> Eigen::Vector3d {
    return {-0.2 + 0.6 * u, -0.2 + 0.4 * v, 0.0};
  });
  compute_vertex_normals(mesh);
  Random random(7);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const double shift = std::clamp(0.5 * random.normal(), -1.0, 1.0) * push.noise;
    mesh.vertices[i] += static_cast<float>(shift) * mesh.normals[i];
  }
  mesh.normals.clear();
  return mesh;
}

inline const Eigen::Vector3d kPushedSides(0.1, 0.12, 0.13);

/// A box with its front at x = 0.05, and the scan.
inline WorldModel world_of(const ScanPush& push) {
  BodyPhysics physics;
  physics.friction.mass = push.mass;
  physics.friction.limiting_force = push.limit;
  physics.friction.coulomb_force = 0.85 * push.limit;
  physics.contact = {20000.0, 60.0, 1.0};
  physics.friction_radius = 0.045;
  WorldModel model;
  model.bodies.push_back(
      {box_model(kPushedSides, "r_box"), standing_at(0.0, 0.0, 0.0, kPushedSides.z()), physics});
  model.tool_radius = kTipRadius;
  model.static_mesh_base = scan_of(push);
  return model;
}

/// The tip's centre; after 0.2 m it rests.
inline Eigen::Vector3d tip_at(const ScanPush& push, double t) {
  return {-0.5 * kPushedSides.x() - kTipRadius - 0.002 + std::min(push.speed * t, 0.2), push.offset,
          0.05};
}

/// Measures how deep the points of a scan are inside of a body.
class ScanDepth {
 public:
  ScanDepth(const WorldBody& body, const TriangleMesh& scan_base, double min_height)
      : surface_(body.model.mesh_object, Pose()) {
    for (const Eigen::Vector3f& v : scan_base.vertices) {
      if (v.z() > min_height) points_.push_back(v.cast<double>());
    }
  }
  /// [m] of the deepest; 0 where none is inside.
  [[nodiscard]] double deepest(const Pose& T_base_object) const {
    double depth = 0.0;
    const Pose T_object_base = T_base_object.inverse();
    for (const Eigen::Vector3d& point : points_) {
      const auto closest = surface_.closest(T_object_base * point, 1e-6);
      if (closest) depth = std::max(depth, -closest->distance);
    }
    return depth;
  }

 private:
  detail::ClosestSurface surface_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace pcavr::test
