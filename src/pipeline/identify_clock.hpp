// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "pcavr/core/expected.hpp"

#include "identify_parts.hpp"

namespace pcavr {

/// Clocks of force and tool that are some seconds apart: the instants at which the force shows
/// contact, against those at which the tip is at an object's surface. Only where one shift, up to a
/// minute, makes both agree decisively better than no shift.
[[nodiscard]] std::optional<Error> clock_fault(const IdentificationInput& input,
                                               const Segmentation& found, const PathView& tip,
                                               const ObjectPlaces& places);
/// The same of the first ten minutes that a replay is given.
[[nodiscard]] std::optional<Error> clock_fault(const TeleopInput& input);

}  // namespace pcavr
