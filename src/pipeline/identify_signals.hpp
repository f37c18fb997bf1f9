// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/identification/path_view.hpp"
#include "pcavr/identification/segmentation.hpp"
#include "pcavr/identification/signals.hpp"

namespace pcavr {

/// The tip without single wild samples.
[[nodiscard]] std::vector<Eigen::Vector3d> without_spikes(std::span<const Eigen::Vector3d> points);

/// Instants [s] at which the tip leaps farther than any tip can between two samples.
[[nodiscard]] std::vector<double> find_jumps(std::span<const double> t,
                                             std::span<const Eigen::Vector3d> points);

/// How much later the force's stamps are than the tool's. While a press lasts, and while a push is
/// let go, the object stands, so that the tip's place is
///     q(t - offset) = surface + c u + e u q',  u = F^(1/n),
/// by the law of the contact and its damping; the offset is the one of the smallest residual, first
/// on a grid over +-0.25 s, then by the slope of q. n of 1, 1.5 or 2 by the residual. The grid is
/// searched in smoothed signals; where there are presses, the rest of the way goes by those
/// measured.
[[nodiscard]] TimeOffset force_offset(const Segmentation& found, std::span<const double> t_force,
                                      const PathView& tip);

}  // namespace pcavr
