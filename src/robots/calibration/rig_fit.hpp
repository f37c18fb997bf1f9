// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "robots/calibration/noise_components.hpp"
#include "robots/calibration/rig.hpp"

namespace pcavr {

struct RigFitOptions {
  CameraMount mount = CameraMount::arm;
  bool with_scale = false;  ///< estimates the board's scale, too
};

struct RigFit {
  Rig rig = {};
  Variances variances{};
  RigMatrix information = {};
  RigMatrix covariance = {};  ///< without what is not observable
  int observable_parameters = 0;
  std::vector<std::size_t> used = {};  ///< indices of the views that were fitted
  /// The direction in mount's axes along which T_mount_camera does not show.
  std::optional<Eigen::Vector3d> unobservable = {};
};

/// How far the mount's rotations spread, by the two main axes [rad rms], and the main axis.
struct RotationSpread {
  double first = 0.0, second = 0.0;
  Eigen::Vector3d axis_mount = Eigen::Vector3d::UnitZ();
};
[[nodiscard]] RotationSpread rotation_spread(const std::vector<RigView>& views,
                                             const std::vector<std::size_t>& indices);

/// The best start among the closed forms of all views, and of a few drawn at random, so that wrong
/// views can't spoil all. nullopt where no motion has a rotation.
[[nodiscard]] std::optional<Rig> find_start(const std::vector<RigView>& views,
                                            const std::vector<std::size_t>& indices);

/// Typical residual of a rig: medians, as std by coordinate.
struct TypicalResidual {
  double position = 0.0;  ///< [m]
  double rotation = 0.0;  ///< [rad]
};
[[nodiscard]] TypicalResidual typical_residual(const std::vector<RigView>& views,
                                               const std::vector<std::size_t>& indices,
                                               const Rig& rig);

/// Fits the rig and the variances of the noise from a start, and leaves out the views that the
/// noise does not explain.
[[nodiscard]] RigFit fit_rig(const std::vector<RigView>& views,
                             const std::vector<std::size_t>& indices, const Rig& start,
                             const RigFitOptions& options);

/// Fits again from a fit, of these views, none of which is left out.
[[nodiscard]] RigFit refit_rig(const std::vector<RigView>& views,
                               const std::vector<std::size_t>& indices, const RigFit& start,
                               const RigFitOptions& options);

/// -2 log of the restricted likelihood of a fit with these sources of noise alone.
[[nodiscard]] double deviance_with(const std::vector<RigView>& views, const RigFit& fit,
                                   const RigFitOptions& options,
                                   const std::array<bool, kSources>& sources);

/// The point of the board [m] whose position is independent of the rotation's noise: by the
/// correlation of both residuals, with a prior that it is within a board's size of the origin.
[[nodiscard]] Eigen::Vector3d best_point(const std::vector<RigView>& views, const RigFit& fit);

[[nodiscard]] std::vector<LinearView> linearised(const std::vector<RigView>& views,
                                                 const std::vector<std::size_t>& indices,
                                                 const Rig& rig, CameraMount mount);

/// An orthonormal basis of the rig's parameters that are estimated.
[[nodiscard]] Eigen::MatrixXd estimated_basis(const RigFit& fit, const std::vector<RigView>& views,
                                              const RigFitOptions& options);

/// How far the variances moved, by their shares in the residual of a view of this shape.
[[nodiscard]] double variance_change(const NoiseShape& shape, const Variances& before,
                                     const Variances& after);

/// Squared distance of a view from the fit in its stds; 6 on average.
[[nodiscard]] double squared_distance(const LinearView& view, const RigFit& fit, bool is_used);
/// Above it a view is an outlier.
[[nodiscard]] double outlier_limit(std::size_t used_views);

}  // namespace pcavr
