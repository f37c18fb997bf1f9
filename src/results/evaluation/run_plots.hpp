// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/base/report/plot.hpp"

#include "comparison_side.hpp"
#include "findings.hpp"

namespace pcavr {

/// Shades the object's phases in plots over time; for a prediction, pins show when corrections took
/// effect at the operator's site.
void annotate(const ObjectFindings& object, const RunFindings& run, Stamp origin,
              const std::vector<Plot*>& plots);

/// The object's displacement along the direction of its maximum displacement: true, tracked,
/// predicted, with its time nodes [paper C, Fig. 10 and 11]. Empty where it is below 1 mm: noise.
[[nodiscard]] std::optional<Plot> motion_plot(const ObjectFindings& object,
                                              const ComparisonSide& reference,
                                              const ComparisonSide& subject,
                                              const Findings& findings);

/// Measured and rendered force over time, with phases and time nodes [paper C, Fig. 11].
[[nodiscard]] Plot force_plot(const std::string& object, const Findings& findings);

/// Every object's phases: true, measured, predicted.
[[nodiscard]] std::vector<Lane> phase_lanes(const Findings& findings);

}  // namespace pcavr
