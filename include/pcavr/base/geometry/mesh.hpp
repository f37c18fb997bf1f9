// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/image.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

/// Points in one frame, given by the suffix of the variable's name (cloud_base). `normals` and
/// `colors` are empty or as long as `points`.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;   ///< [m]
  std::vector<Eigen::Vector3f> normals;  ///< unit length
  std::vector<Rgb8> colors;              ///< sRGB
};

/// An indexed triangle mesh; triangles are counter-clockwise seen from outside. `normals` and
/// `colors` are empty or as long as `vertices`.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;  ///< [m]
  std::vector<Eigen::Vector3f> normals;   ///< unit length
  std::vector<Rgb8> colors;               ///< sRGB
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The points p with normal . p == offset.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit length
  double offset = 0.0;                                ///< [m]

  [[nodiscard]] double signed_distance(const Eigen::Vector3d& point) const {
    return normal.dot(point) - offset;
  }
};

[[nodiscard]] Eigen::AlignedBox3f bounds(const std::vector<Eigen::Vector3f>& points);

/// Total area of the triangles [m^2].
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// Volume enclosed [m^3], positive where the winding is outward; meaningful for closed meshes.
[[nodiscard]] double signed_volume(const TriangleMesh& mesh);

/// The mesh transformed from frame b to frame a.
[[nodiscard]] TriangleMesh transformed(const Pose& T_a_b, const TriangleMesh& mesh_b);

/// Replaces the normals by the area-weighted mean of the adjacent triangles' normals.
void compute_vertex_normals(TriangleMesh& mesh);

}  // namespace pcavr
