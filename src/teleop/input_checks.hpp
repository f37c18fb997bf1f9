// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/identification/signals.hpp"
#include "pcavr/teleop/run_teleop.hpp"

#include "teleop/recorded_signals.hpp"

namespace pcavr {

/// Faults of a recording's force and clocks that can be detected from its data alone.
struct InputFindings {
  bool is_force_usable = true;
  std::optional<double> force_ceiling = {};       ///< [N] where the sensor saturates
  std::optional<TimeOffset> tool_to_force = {};   ///< delay of the force
  std::optional<TimeOffset> tool_to_camera = {};  ///< delay of the tracking
  std::vector<std::string> notes;
};

/// Analyses the recording once, as a calibration before the run would: sign and unit of the force
/// by its cross-correlation with the tip's penetration of the tracked bodies; saturation; the clock
/// offsets by the same correlation, and by the pushed object's motion against the tip's. Of a long
/// recording, sign, unit and offset by the first ten minutes from which they can be estimated.
[[nodiscard]] InputFindings check_input(const TeleopInput& input, const TipMotion& tip);

}  // namespace pcavr
