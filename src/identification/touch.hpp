// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pcavr/identification/signals.hpp"

namespace pcavr {

/// What a touch is looked for in; all of one length.
struct TouchSignals {
  std::span<const double> t;               ///< [s]
  std::vector<double> force;               ///< [N] despiked, not smoothed: its noise is white
  std::vector<SmoothedSample> tool;        ///< [m]
  std::vector<SmoothedSample> soft_force;  ///< [N] smoothed
};

/// When the tool met the surface [s]. A force is seen late: at 5 mm/s a soft face takes 0.2 s from
/// the touch to six deviations of noise. So the rise is fitted by F = f0 + a (d - surface)^n, n
/// from 1 to 2.5, from free space up to half of the peak, and carried back to the surface.
/// `detected` is the first sample in contact for sure, `peak` one where the force is largest;
/// `earliest` a sample before which the fit may not look. Gives t[detected] where there is too
/// little to fit.
[[nodiscard]] double touch_instant(const TouchSignals& signals, std::size_t earliest,
                                   std::size_t detected, std::size_t peak);

/// The same for the parting: `detected` is the last sample in contact for sure, `latest` the last
/// one that the fit may look at.
[[nodiscard]] double parting_instant(const TouchSignals& signals, std::size_t peak,
                                     std::size_t detected, std::size_t latest);

}  // namespace pcavr
