// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/identification/path_view.hpp"
#include "pcavr/identification/segmentation.hpp"

namespace pcavr {

/// A short interval of force, samples [begin, end).
struct ForcePulse {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Intervals of at most `max_impact` in which a force exceeds its noise. Without smoothing and with
/// spikes: an impact of 2 ms is a single sample, which only the tool's motion tells from a spike.
/// `noise` is the std of one sample of one axis [N].
[[nodiscard]] std::vector<ForcePulse> find_pulses(std::span<const double> t,
                                                  std::span<const Eigen::Vector3d> force_base,
                                                  double noise, const SegmentationOptions& options);

/// The impact of a pulse, with its direction: that of the impulse.
struct FoundImpact {
  Eigen::Vector3d direction_base = Eigen::Vector3d::Zero();
  ImpactMotion motion;
};

/// Whether the tool's motion changes as the pulse's force demands. The tool's path is fitted by a
/// mass that flies freely but for this force, p = p0 + v0 t - (1/m) double integral of F: linear
/// least squares over the pulse and the free motion around it, up to `free_from` and `free_to` [s].
/// `noise` as above.
/// Empty where the change of speed is not significant, or the tool hardly approached.
[[nodiscard]] std::optional<FoundImpact> find_impact(const ForcePulse& pulse,
                                                     std::span<const double> t,
                                                     std::span<const Eigen::Vector3d> force_base,
                                                     const PathView& tip, double free_from,
                                                     double free_to, double noise,
                                                     const SegmentationOptions& options);

}  // namespace pcavr
