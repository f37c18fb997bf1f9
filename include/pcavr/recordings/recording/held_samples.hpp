// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// A source that is republished faster than it changes: each of its values stands in several rows,
/// so that the signal is a staircase. These functions leave out the rows that repeat the row
/// before, but one for each period of the source where it rests. Return a note that names `stream`,
/// both rates and the number of rows left out; nullopt, and nothing left out, where values don't
/// repeat at the pace of a clock: at rest, or where a sensor's resolution is coarse. Thread-safe.
[[nodiscard]] std::optional<std::string> leave_out_held(const std::string& stream,
                                                        Trajectory& poses);
[[nodiscard]] std::optional<std::string> leave_out_held(const std::string& stream,
                                                        std::vector<WrenchSample>& wrench);

}  // namespace pcavr
