// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "pcavr/friction/limit_surface.hpp"

namespace pcavr {

/// What one push told: the wrench that moved the body (its mean over the push) and the twist, of
/// any length, that it moved with; both in the axes of LimitSurface.
struct PushSample {
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
};

enum class SurfaceShape {
  ellipsoid,  ///< six numbers: enough for a dozen pushes
  quartic,    ///< fifteen; pulled towards the fitted ellipsoid where the pushes are silent
};

/// The weights are those that predict unseen pushes best on simulated supports of many Coulomb
/// patches, even, uneven, on points and rings, with sensor noise (tests/friction).
struct LimitSurfaceFitOptions {
  SurfaceShape shape = SurfaceShape::quartic;
  /// How much one sample's distance from the surface counts against its direction. The wrench's
  /// length is noisier than its direction where the support is uneven.
  double level_weight = 0.03;
  /// Weight of the ellipsoid against all pushes together; 0 trusts the pushes alone.
  double prior_weight = 0.007;
};

enum class LimitSurfaceFitStatus {
  fitted,
  too_few_pushes,  ///< fewer usable samples than the shape has coefficients
  not_excited,     ///< the wrenches or twists lie in a plane: say, no push turned the body
};

struct LimitSurfaceFit {
  LimitSurfaceFitStatus status = LimitSurfaceFitStatus::too_few_pushes;
  LimitSurface surface;
  int samples_used = 0;
  double median_angle = 0.0;  ///< between predicted and seen twist, over the samples used [rad]
};

/// Fits a convex limit surface to pushes [after Zhou et al. 2016]. The quartic is a sum of fourth
/// powers of linear forms with weights >= 0, so that it is convex by construction, where the paper
/// solves a semidefinite programme; the weights are a non-negative least squares problem in the
/// twist's component across the surface's normal, reweighted so that outliers count by their angle.
/// Samples that are zero or not finite are left out. Deterministic; allocates.
[[nodiscard]] LimitSurfaceFit fit_limit_surface(std::span<const PushSample> samples,
                                                const LimitSurfaceFitOptions& options = {});

}  // namespace pcavr
