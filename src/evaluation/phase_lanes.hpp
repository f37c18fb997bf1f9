// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pcavr {

/// A stretch of one phase.
struct PhaseStretch {
  double from = 0.0;  ///< [s]
  double to = 0.0;    ///< [s]
  int phase = 0;      ///< 0 to 3, as Phase has them
};

/// One record of an object's phases as a lane of coloured stretches.
struct PhaseLane {
  std::string object;
  std::string label;  ///< "truth", "measured", "predicted"
  std::vector<PhaseStretch> stretches;
};

/// The lanes below each other over one time axis, as an HTML figure; empty where there are none.
[[nodiscard]] std::string format_lanes(const std::vector<PhaseLane>& lanes);

}  // namespace pcavr
