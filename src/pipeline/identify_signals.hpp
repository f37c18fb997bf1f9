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

/// The tip's path with outliers (spikes) replaced.
[[nodiscard]] std::vector<Eigen::Vector3d> without_spikes(std::span<const Eigen::Vector3d> points);

/// Times [s] at which the tip jumps farther between two samples than a tip can accelerate.
[[nodiscard]] std::vector<double> find_jumps(std::span<const double> t,
                                             std::span<const Eigen::Vector3d> points);

/// Clock offset: the delay of the force's stamps against the tool's. During a press, and while a
/// push is released, the object is at rest, so that the tip's position is
///     q(t - offset) = surface + c u + e u q',  u = F^(1/n),
/// by the contact law with damping. The offset with the smallest residual is found by a grid search
/// over +-0.25 s on smoothed signals, then refined by Gauss-Newton: on the measured signals where
/// there are presses, else on the smoothed ones. n is 1, 1.5 or 2, by the residual.
[[nodiscard]] TimeOffset force_offset(const Segmentation& found, std::span<const double> t_force,
                                      const PathView& tip);

}  // namespace pcavr
