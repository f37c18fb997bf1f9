// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "findings.hpp"
#include "report.hpp"

namespace pcavr {

/// The results published in papers B and C, and this run's. Theirs are of real boxes, sensors and
/// people: the table shows the difference, it is no ranking.
[[nodiscard]] ReportTable paper_table(const Findings& findings);

/// The peak force of each contact, measured and rendered; where there are presses, with paper B's
/// table 3 below.
[[nodiscard]] ReportTable contact_table(const Findings& findings);

}  // namespace pcavr
