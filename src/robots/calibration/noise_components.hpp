// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "robots/calibration/rig.hpp"

namespace pcavr {

/// The sources of noise, in the order of HandEyeNoise. Each acts on a view's residual through a
/// matrix of its own, by unit variance.
inline constexpr std::size_t kSources = 5;
using Variances = std::array<double, kSources>;

/// How the sources act on one view.
struct NoiseShape {
  Eigen::Matrix3d lever;   ///< position by a rotation of the arm, -[lever]x
  Eigen::Matrix3d across;  ///< [m^2] covariance by unit variance of camera_across
  Eigen::Matrix3d along;   ///< [m^4] of camera_depth
};
[[nodiscard]] NoiseShape noise_shape(const RigView& view, const Rig& rig, CameraMount mount);

/// The covariance of a residual by one source of unit variance.
[[nodiscard]] Matrix6d covariance_of_source(const NoiseShape& shape, std::size_t source);
/// The covariance by all sources.
[[nodiscard]] Matrix6d covariance_of(const NoiseShape& shape, const Variances& variances);

/// A linearised view.
struct LinearView {
  NoiseShape shape;
  Vector6d residual;
  RigJacobian jacobian;
};

/// One step of restricted maximum likelihood of the variances, which takes into account that the
/// residuals are those of a fit [Patterson & Thompson 1971], in the form whose factors keep them
/// positive [Zhou, Hu, Qiao & Zhou 2019, algorithm 1]. `covariance`: of the rig's parameters.
[[nodiscard]] Variances improved(const std::vector<LinearView>& views, const RigMatrix& covariance,
                                 const Variances& variances);

/// -2 log of the restricted likelihood, but for a constant. `information`: of the parameters.
[[nodiscard]] double deviance(const std::vector<LinearView>& views, const RigMatrix& information,
                              int observable_parameters, const Variances& variances);

/// Covariance of the variances by the expected information of the restricted likelihood, without
/// its terms between different views.
[[nodiscard]] Eigen::Matrix<double, kSources, kSources> covariance_of_variances(
    const std::vector<LinearView>& views, const RigMatrix& covariance, const Variances& variances);

}  // namespace pcavr
