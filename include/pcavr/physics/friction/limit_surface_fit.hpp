// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "pcavr/base/core/options.hpp"
#include "pcavr/physics/friction/limit_surface.hpp"

namespace pcavr {

/// The measurement of one push: the wrench that moved the body (its mean over the push) and the
/// twist, of any length, of its motion; both in the axes of LimitSurface.
struct PushSample {
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
  /// [m] From the centre of mass, where a push above the support has moved the pressure: what the
  /// moment and the motion are about. Not used by the fit.
  Eigen::Vector2d centre_of_pressure = Eigen::Vector2d::Zero();
  std::size_t push = 0;  ///< samples of one push share errors. Not used by the fit
};

enum class SurfaceShape {
  ellipsoid,  ///< six numbers: enough for a dozen pushes
  quartic,    ///< fifteen; regularised towards the fitted ellipsoid where pushes are missing
};

/// The default weights are those that predict held-out pushes best on simulated supports of many
/// Coulomb patches, even, uneven, on points and rings, with sensor noise (tests/friction). Defaults
/// and ranges: src/physics/friction/options.cpp.
struct LimitSurfaceFitOptions {
  LimitSurfaceFitOptions();
  SurfaceShape shape;  ///< quartic
  /// Weight of one sample's distance from the surface relative to its direction. The wrench's
  /// magnitude is noisier than its direction where the support is uneven.
  double level_weight;
  /// Weight of the ellipsoid (the prior) relative to all pushes together; 0: the pushes alone.
  double prior_weight;
  /// The same of a prior that is given.
  double given_prior_weight;
  double min_angle;   ///< [rad] of error below which a sample gains no more weight: its noise
  double min_spread;  ///< of wrenches and twists out of a plane, to be excited
};
[[nodiscard]] OptionSection section_of(LimitSurfaceFitOptions& options);

enum class LimitSurfaceFitStatus {
  fitted,
  too_few_pushes,  ///< fewer usable samples than the shape has coefficients
  not_excited,     ///< the wrenches or twists lie in a plane: e.g. no push rotated the body
};

struct LimitSurfaceFit {
  LimitSurfaceFitStatus status = LimitSurfaceFitStatus::too_few_pushes;
  LimitSurface surface;
  int samples_used = 0;
  double median_angle = 0.0;  ///< between predicted and measured twist, over the samples used [rad]
};

/// Fits a convex limit surface to pushes [after Zhou et al. 2016]. The quartic is a sum of fourth
/// powers of linear forms with weights >= 0, so that it is convex by construction, where the paper
/// solves a semidefinite programme; the weights are a non-negative least squares problem (NNLS) in
/// the twist's component across the surface's normal, iteratively reweighted (IRLS) so that
/// outliers count by their angle. Samples that are zero or not finite are ignored. `prior` takes
/// the place of the ellipsoid; its size does not count. Deterministic; allocates.
[[nodiscard]] LimitSurfaceFit fit_limit_surface(std::span<const PushSample> samples,
                                                const LimitSurfaceFitOptions& options = {},
                                                const std::optional<LimitSurface>& prior = {});

}  // namespace pcavr
