// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/segmentation.hpp"

namespace pcavr {

/// A short interval of force, samples [begin, end).
struct ForcePulse {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Intervals of at most `max_impact` in which a force exceeds its noise. Without smoothing and with
/// spikes: an impact of 2 ms is a single sample, which only the tool's motion distinguishes from a
/// spike. `noise` is the std of one sample of one axis [N].
[[nodiscard]] std::vector<ForcePulse> find_pulses(std::span<const double> t,
                                                  std::span<const Eigen::Vector3d> force_base,
                                                  double noise, const SegmentationOptions& options);

/// The impact of a pulse, with its direction: that of the impulse.
struct FoundImpact {
  Eigen::Vector3d direction_base = Eigen::Vector3d::Zero();
  ImpactMotion motion;
};

/// Whether the tool's speed changes with the pulse: lines through its path before and after, up to
/// `free_from` and `free_to` [s]. Without the force, whose integral would add its noise to the
/// speeds. `noise` as above. Empty where the change is not significant, where one smooth path fits
/// as well, or where the tool hardly approached.
[[nodiscard]] std::optional<FoundImpact> find_impact(const ForcePulse& pulse,
                                                     std::span<const double> t,
                                                     std::span<const Eigen::Vector3d> force_base,
                                                     const PathView& tip, double free_from,
                                                     double free_to, double noise,
                                                     const SegmentationOptions& options);

}  // namespace pcavr
