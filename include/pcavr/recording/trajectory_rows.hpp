// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "pcavr/core/stamp.hpp"
#include "pcavr/geometry/pose.hpp"

namespace pcavr {

/// format_trajectory() in parts, for writing a trajectory incrementally: the first line, and a line
/// for each pose, with strictly ascending stamps.
[[nodiscard]] std::string_view trajectory_header();
void append_trajectory_row(std::string& text, Stamp stamp, const Pose& pose);

}  // namespace pcavr
