// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {

/// Signals in which begin and end of contact are searched; all of one length.
struct TouchSignals {
  std::span<const double> t;                 ///< [s]
  std::vector<double> force;                 ///< [N] despiked, not smoothed: its noise is white
  std::vector<SmoothedSample> tool;          ///< [m]
  std::vector<SmoothedSample> smooth_force;  ///< [N]
};

/// The time at which the tool met the surface [s]. Force detection is late: at 5 mm/s on a soft
/// face it is 0.2 s from the touch to six stds of noise. So the rise is fitted from free space up
/// to half of the peak by F = f0 + a (d - surface)^n, n from 1 to 2.5, and extrapolated to the
/// surface.
/// `detected` is the first sample in contact for sure, `peak` one where the force is largest;
/// `earliest` the first sample that the fit may use. Returns t[detected] where there are too few
/// samples to fit.
[[nodiscard]] double touch_instant(const TouchSignals& signals, std::size_t earliest,
                                   std::size_t detected, std::size_t peak);

/// The same for the separation: `detected` is the last sample in contact for sure, `latest` the
/// last one that the fit may use.
[[nodiscard]] double separation_instant(const TouchSignals& signals, std::size_t peak,
                                        std::size_t detected, std::size_t latest);

}  // namespace pcavr
