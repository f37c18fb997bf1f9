// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/identification/path_view.hpp"
#include "pcavr/inputs/input_findings.hpp"

#include "inputs/body_poses.hpp"

namespace pcavr {

/// A fault where the clocks of force and tool are some seconds apart, by cross-correlation of the
/// times at which the force shows contact with those at which the tip is at an object's surface.
/// Only where a shift, up to a minute, correlates decisively better than no shift.
[[nodiscard]] std::optional<InputFault> clock_fault(const InputSeries& series,
                                                    const Segmentation& found, const PathView& tip,
                                                    const BodyPoses& poses);

}  // namespace pcavr
