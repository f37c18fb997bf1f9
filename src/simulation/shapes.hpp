// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::simulation {

/// The surface of one body in its own frame: exact triangles with shading attributes.
struct Surface {
  TriangleMesh mesh;                    ///< closed parts, outward winding
  std::vector<Eigen::Vector3f> normal;  ///< by triangle: unit, outward
  /// By triangle: unit normals at its corners, for shading. Equal to the triangle's own on flat
  /// faces.
  std::vector<std::array<Eigen::Vector3f, 3>> corner_normals;
  std::vector<std::uint32_t> facet;     ///< by triangle: differs across creases, not within a face
  std::vector<std::uint16_t> material;  ///< by triangle: index into the body's materials
};

/// Adds a surface of revolution about z, closed by a profile that runs from the axis to the axis,
/// counter-clockwise seen with r to the right and z up. `profile` holds (r, z) [m]. Edges of the
/// profile that bend by less than 40 degrees are shaded smoothly.
void add_revolution(Surface& surface, const std::vector<Eigen::Vector2d>& profile, int segments,
                    const Pose& T_body_shape, std::uint16_t material);

/// Adds an upright prism over a convex polygon (counter-clockwise seen from above) [m].
void add_prism(Surface& surface, const std::vector<Eigen::Vector2d>& polygon, double bottom,
               double top, const Pose& T_body_shape, std::uint16_t material);

/// Adds a cuboid centred at the shape's origin.
void add_box(Surface& surface, const Eigen::Vector3d& half_extents, const Pose& T_body_shape,
             std::uint16_t material);

/// Adds a cuboid centred at the origin with a slot along its y that is open above and at both ends:
/// from -half_slot to half_slot [m] in x, and from `floor` [m] in z up.
void add_slotted_block(Surface& surface, const Eigen::Vector3d& half_extents, double half_slot,
                       double floor, std::uint16_t material);

/// A hole with an oblique axis in a block: the same rectangle at every height, moving along x.
struct ObliqueHole {
  Eigen::Vector2d half_extents;  ///< of the rectangle in x and y [m]
  Eigen::Vector2d mouth;         ///< its middle at the top face, from the block's middle [m]
  Eigen::Vector2d bottom;        ///< its middle at the floor: the same y [m]
  double floor = 0.0;            ///< z of the floor, from the block's middle [m]
};

/// Adds a cuboid centred at the origin with such a hole in its top face.
void add_block_with_hole(Surface& surface, const Eigen::Vector3d& half_extents,
                         const ObliqueHole& hole, std::uint16_t material);

/// Adds a mesh, each triangle flat.
void add_mesh(Surface& surface, const TriangleMesh& mesh, std::uint16_t material);

/// Profiles for add_revolution; they stand on z = 0.
[[nodiscard]] std::vector<Eigen::Vector2d> cylinder_profile(double radius, double height);
[[nodiscard]] std::vector<Eigen::Vector2d> sphere_profile(double radius);
[[nodiscard]] std::vector<Eigen::Vector2d> cup_profile(double radius, double height, double wall);

}  // namespace pcavr::simulation
