// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "comparison_side.hpp"
#include "findings.hpp"
#include "phase_lanes.hpp"
#include "svg_plot.hpp"

namespace pcavr {

/// Shades the object's phases in plots over time; for a prediction, pins show when corrections took
/// effect in what the operator saw.
void annotate(const ObjectFindings& object, const RunFindings& run, Stamp origin,
              const std::vector<Plot*>& plots);

/// How far the object got in the direction in which it got farthest: true, tracked, predicted, with
/// its time nodes [paper C, Fig. 10 and 11]. Nothing where it kept within 1 mm, which is noise.
[[nodiscard]] std::optional<Plot> motion_plot(const ObjectFindings& object,
                                              const ComparisonSide& reference,
                                              const ComparisonSide& subject,
                                              const Findings& findings);

/// Force measured and felt over time, with phases and time nodes [paper C, Fig. 11].
[[nodiscard]] Plot force_plot(const std::string& object, const Findings& findings);

/// Every object's phases: true, measured, predicted.
[[nodiscard]] std::vector<PhaseLane> phase_lanes(const Findings& findings);

}  // namespace pcavr
