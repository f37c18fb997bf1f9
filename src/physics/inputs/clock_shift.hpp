// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"

#include "physics/inputs/body_poses.hpp"
#include "physics/inputs/clock_offsets.hpp"

namespace pcavr {

/// A fault where the clocks of force and tool are some seconds apart, by cross-correlation of the
/// times at which the force shows contact with those at which the tip is at an object's surface. It
/// is found only where a shift, up to a minute, correlates decisively better than no shift.
[[nodiscard]] std::optional<InputFault> clock_fault(const InputSeries& series,
                                                    const Segmentation& found, const PathView& tip,
                                                    const BodyPoses& poses);

/// A delay of the force that the touches show, where it is not corrected.
[[nodiscard]] InputFault touch_fault(const TimeOffset& delay);

/// A fault where one clock is so fast that speeds are wrong.
[[nodiscard]] std::optional<InputFault> drift_fault(const ClockDrift& drift);

}  // namespace pcavr
