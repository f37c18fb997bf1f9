// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace pcavr {

/// A pixel near an edge, in coordinates along and across the initial guess of it.
struct EdgeSample {
  double along = 0.0;   ///< [px], from the edge's middle
  double across = 0.0;  ///< [px], from the initial line
  double grey = 0.0;    ///< 0 to 255
};

/// The line across = offset + slope * along.
struct EdgeFit {
  double offset = 0.0;  ///< [px]
  double slope = 0.0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of (offset, slope)
};

/// Least-squares fit of a Gaussian-blurred step, grey = low + contrast * Phi((across - line) /
/// blur), by Gauss-Newton with Huber weights (IRLS), so that a stain or a finger on the edge gets
/// little weight. Nothing if there are too few samples, no contrast, or the line leaves the `reach`
/// [px].
[[nodiscard]] std::optional<EdgeFit> fit_edge(std::span<const EdgeSample> samples, double reach);

}  // namespace pcavr
