// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "pcavr/core/stamp.hpp"
#include "pcavr/geometry/pose.hpp"

namespace pcavr {

/// The parts of what format_trajectory() writes, for trajectories that nobody keeps whole: the
/// first line, and a line for each pose, stamps ascending strictly.
[[nodiscard]] std::string_view trajectory_header();
void append_trajectory_row(std::string& text, Stamp stamp, const Pose& pose);

}  // namespace pcavr
