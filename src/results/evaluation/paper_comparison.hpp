// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "findings.hpp"
#include "report.hpp"

namespace pcavr {

/// The presses of a run that is one of paper B's experiments, in which they are at least half of
/// the contacts, and at its speeds: neither those beside pushes nor impacts. `soft`: see
/// is_soft_press.
[[nodiscard]] std::vector<ContactPeak> experiment_presses(const RunFindings& run, bool soft);

/// The results published in papers B and C, and this run's. Theirs are of real boxes, sensors and
/// people: the table shows the difference, it is no ranking.
[[nodiscard]] ReportTable paper_table(const Findings& findings);

/// The peak force of each contact, measured and rendered.
[[nodiscard]] ReportTable contact_table(const Findings& findings);

/// Paper B's table 3 (presses by speed), table 4 (soft object) and figure 6 (damping laws), each
/// beside this run's values, for runs of such presses, or with a restitution.
[[nodiscard]] std::vector<ReportTable> contact_paper_tables(const Findings& findings);

}  // namespace pcavr
