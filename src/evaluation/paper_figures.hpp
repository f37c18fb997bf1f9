// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "findings.hpp"
#include "report.hpp"

namespace pcavr {

/// The figures that papers B and C print, beside this run's. Theirs are of real boxes, sensors and
/// people: the table shows how far one is from the other, it does not rank them.
[[nodiscard]] ReportTable paper_table(const Findings& findings);

/// The largest force of each contact, measured and felt; where nothing slides, with paper B's table
/// 3 below.
[[nodiscard]] ReportTable contact_table(const Findings& findings);

/// |felt - measured| / measured of the largest forces, over all objects' contacts.
[[nodiscard]] std::vector<double> peak_errors(const RunFindings& run);

}  // namespace pcavr
