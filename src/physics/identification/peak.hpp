// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

struct PeakSignals {
  std::span<const double> t;                     ///< [s]
  std::span<const double> force;                 ///< [N] despiked, not smoothed
  std::span<const SmoothedSample> smooth_force;  ///< [N]
  double noise = 0.0;                            ///< [N] of one raw sample
  double smooth_noise = 0.0;                     ///< [N] of one smoothed sample
  double half_width = 0.0;                       ///< [s] of the smoothing
};

struct ForcePeak {
  double t = 0.0;
  double force = 0.0;
  double std = 0.0;  ///< [N] from the noise
};

/// The first of the peaks that equal the highest one within noise, within [begin, highest]: on a
/// plateau, or among the peaks of stick-slip, the highest one is random.
[[nodiscard]] std::size_t first_peak(const PeakSignals& signals, std::size_t begin,
                                     std::size_t highest);

/// Time and height of the peak about a sample. The maximum of many noisy values is biased high, and
/// the mean over a window biased low where the peak is sharp: a parabola is fitted over the widest
/// window in which its residual is within the noise [after Lepski 1990].
[[nodiscard]] ForcePeak fit_peak(const PeakSignals& signals, std::size_t about);

}  // namespace pcavr
