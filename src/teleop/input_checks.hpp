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

/// What is wrong with a recording's force and clocks, as far as they tell by themselves.
struct InputFindings {
  bool is_force_usable = true;
  std::optional<double> force_ceiling = {};       ///< [N] where the sensor saturates
  std::optional<TimeOffset> tool_to_force = {};   ///< the force is this much late
  std::optional<TimeOffset> tool_to_camera = {};  ///< tracking is this much late
  std::vector<std::string> notes;
};

/// Looks at the recording once, as a calibration before the run would: the sign and the unit of the
/// force by its correlation with how far the tip presses into the tracked bodies, a flat top, the
/// clocks' offsets by the same correlation and by what is pushed against what pushes. Of a long
/// recording, sign, unit and offset by the first ten minutes that tell them.
[[nodiscard]] InputFindings check_input(const TeleopInput& input, const TipMotion& tip);

}  // namespace pcavr
