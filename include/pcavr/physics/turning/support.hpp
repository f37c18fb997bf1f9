// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/friction/limit_surface_fit.hpp"

namespace pcavr {

/// The support that an object stands on, by its CAD model: points of equal area under its lowest
/// vertices, about its centre of mass, in its planar axes (heading_of).
class Support {
 public:
  Support(const CadModel& model, const Pose& T_base_object);

  [[nodiscard]] const std::vector<Eigen::Vector2d>& points() const { return points_; }
  /// [m] The points' mean distance from the centre of mass: the friction radius of even pressure;
  /// 0 where it stands on a point.
  [[nodiscard]] double radius() const;
  /// The support scaled about the centre of mass, for an object that stands on feet, or on its rim.
  [[nodiscard]] Support scaled(double factor) const;

  /// Each point's share of the load: of a stiff body on an elastic layer [Winkler's foundation],
  /// which presses linearly over the support, and lifts off where it would pull. Where the centre
  /// of pressure [m] would be near the support's edge or beyond it, the object is about to tip;
  /// then it is the last one in that direction that the support bears. Even on a point or a line.
  [[nodiscard]] std::vector<double> pressure(const Eigen::Vector2d& centre) const;

 private:
  std::vector<Eigen::Vector2d> points_;
};

/// [N, N, N m] About the centre of pressure: the load that viscous friction B [N s/m], spread over
/// the support as its pressure is, takes of a sample. It resists turning by the mean square of the
/// radius, where Coulomb friction does by its mean.
[[nodiscard]] Eigen::Vector3d viscous_load(const Support& support, const PushSample& sample,
                                           double viscous);

/// The support scaled so that its friction is best along the forces that were measured, beside its
/// viscous friction [N s/m]. Empty where no scale does that.
[[nodiscard]] std::optional<Support> scaled_to_pushes(const Support& support,
                                                      std::span<const PushSample> samples,
                                                      double viscous = 0.0);

}  // namespace pcavr
