// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// A push as robot and tracker saw it, each in its own frame.
struct PushSeries {
  const Trajectory& T_base_tip;
  std::span<const WrenchSample> wrench_base;
  const Trajectory& T_world_object;
};

/// The pushed body's sides and the tip that touches them.
struct PushedSides {
  std::vector<Eigen::Vector3d> outline_object;  ///< convex, counter-clockwise, in x and y [m]
  double middle_object = 0.0;                   ///< [m] half its height
  double tip_radius = 0.0;                      ///< [m]

  /// The convex hull of the mesh, seen along z.
  [[nodiscard]] static PushedSides of(const TriangleMesh& mesh_object, double tip_radius);
};

struct WorldPlacement {
  Pose T_base_world;  ///< turned about z only; the z axes of both frames point up
  double tool_delay =
      0.0;  ///< [s] the tip was where a row puts it this much before the row's stamp
  double position_std = 0.0;  ///< [m] of the less certain horizontal direction
  double turn_std = 0.0;      ///< [rad]
  double delay_std = 0.0;     ///< [s]
  double residual = 0.0;      ///< [m] std of the gap between tip and side, by the median
  std::size_t samples = 0;    ///< in contact
};

/// Finds the pose of the tracker's world frame in base with which the tip touches the object's side
/// whenever force and motion show that it pushes the object. Horizontal place, turn about z and the
/// clocks' difference are fitted (Gauss-Newton, Cauchy weights); the height puts the middle of the
/// object's sides at the tip's height. Contact and tip give way by a length that grows with the
/// force, fitted with the others. Several pushes of one object share all of it: on different sides
/// a shift is known from a delay. The std of the place contains other places that fit as well. An
/// Error, without file, for pushes that are too short, that turn the object too little
/// (position_std above 5 mm), or do not fit (residual above 5 mm).
[[nodiscard]] Expected<WorldPlacement> find_world(std::span<const PushSeries> pushes,
                                                  const PushedSides& sides);

}  // namespace pcavr
