// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pcavr {

/// A time interval of one phase.
struct PhaseInterval {
  double from = 0.0;  ///< [s]
  double to = 0.0;    ///< [s]
  int phase = 0;      ///< 0 to 3, as in Phase
};

/// One record of an object's phases as a lane of coloured bars.
struct PhaseLane {
  std::string object;
  std::string label;  ///< "truth", "measured", "predicted"
  std::vector<PhaseInterval> intervals;
};

/// The lanes stacked over one time axis, as an HTML figure; empty where there are none.
[[nodiscard]] std::string format_lanes(const std::vector<PhaseLane>& lanes);

}  // namespace pcavr
