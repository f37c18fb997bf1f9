// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/core/expected.hpp"

#include "identify_parts.hpp"

namespace pcavr {

/// An Error where the clocks of force and tool are some seconds apart, by cross-correlation of the
/// times at which the force shows contact with those at which the tip is at an object's surface.
/// Only where a shift, up to a minute, correlates decisively better than no shift.
[[nodiscard]] std::optional<Error> clock_fault(const IdentificationInput& input,
                                               const Segmentation& found, const PathView& tip,
                                               const ObjectPoses& object_poses);
/// The same for a replay's input, from its first ten minutes.
[[nodiscard]] std::optional<Error> clock_fault(const TeleopInput& input);

}  // namespace pcavr
