// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/pipeline/calibrate_objects.hpp"

namespace pcavr {

/// Where a mesh lies to which a tip's contacts belong: the fit of its pose and scale, by the
/// distances of the tip from its surface.

/// Of x, y, z, rotations about them, and scale: which are fitted.
using ObjectParameterSet = std::array<bool, kObjectParameters>;
using ObjectStds = std::array<double, kObjectParameters>;
using PlacementStep = Eigen::Matrix<double, 7, 1>;

inline constexpr std::size_t kObjectScale = 6;  ///< index of the scale
inline constexpr double kRadPerDegree = std::numbers::pi / 180.0;

/// Pose and scale of the mesh.
struct MeshPlacement {
  Pose T_tracked_object = {};
  double scale = 1.0;
};

/// The distance of the tip from the mesh's surface, and how it changes with the parameters.
struct Gap {
  double value = 0.0;  ///< [m]
  PlacementStep slope = PlacementStep::Zero();
};

/// What is fitted: an object's points, without those of one contact.
struct PlacementProblem {
  const TouchedObject& object;
  const BodySurface& surface;
  std::optional<std::size_t> without = {};
};

/// Empty: the surface has no nearest point.
[[nodiscard]] std::optional<Gap> gap_of(const ContactPoint& point, const MeshPlacement& placement,
                                        const BodySurface& surface, double tip_radius);
[[nodiscard]] std::vector<Gap> gaps_of(const PlacementProblem& problem,
                                       const MeshPlacement& placement);
[[nodiscard]] double rms_of(const std::vector<Gap>& gaps);  ///< [m]

/// Gauss-Newton, damped; a step is limited, so that the nearest faces stay those that were linked.
[[nodiscard]] MeshPlacement fitted(const PlacementProblem& problem, const ObjectParameterSet& free,
                                   MeshPlacement placement);
/// [m^2] Of a point's gap by the residuals, one measurement for each contact: its points share
/// their errors.
[[nodiscard]] double variance_of(const PlacementProblem& problem, const ObjectParameterSet& free,
                                 const MeshPlacement& placement);
/// The stds that gaps of that variance leave.
[[nodiscard]] ObjectStds expected_stds(const PlacementProblem& problem,
                                       const ObjectParameterSet& free,
                                       const MeshPlacement& placement, double variance);
/// The fits without one contact each.
[[nodiscard]] std::vector<MeshPlacement> without_each(const PlacementProblem& problem,
                                                      const ObjectParameterSet& free,
                                                      const MeshPlacement& placement);
[[nodiscard]] ObjectStds jackknife_stds(const MeshPlacement& placement,
                                        const std::vector<MeshPlacement>& without);
/// Of the mean variance. The jackknife's has as few freedoms as a side has contacts, which may
/// agree by chance; that by all residuals takes all contacts as alike.
[[nodiscard]] ObjectStds mean_stds(const ObjectStds& jackknife, const ObjectStds& expected);
/// [m] Of each contact's points by the fit without it.
[[nodiscard]] double held_out_rms(const PlacementProblem& problem,
                                  const std::vector<MeshPlacement>& without);

}  // namespace pcavr
