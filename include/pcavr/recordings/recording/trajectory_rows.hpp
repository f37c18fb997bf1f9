// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

namespace pcavr {

/// format_trajectory() in parts, for writing a trajectory incrementally: the first line, and a line
/// for each pose, with strictly ascending stamps.
[[nodiscard]] std::string_view trajectory_header();
void append_trajectory_row(std::string& text, Stamp stamp, const Pose& pose);

// The same of tool.csv and wrench.csv.
[[nodiscard]] std::string_view tool_header();
void append_tool_row(std::string& text, Stamp stamp, const Pose& T_base_tool);
[[nodiscard]] std::string_view wrench_header();
void append_wrench_row(std::string& text, const WrenchSample& sample);

}  // namespace pcavr
