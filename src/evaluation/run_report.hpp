// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report.hpp"

namespace pcavr {

/// Phases over time, time nodes, settings.
[[nodiscard]] ReportSection overview_section(const Findings& findings);

/// One object's way and force over time, and the force's errors.
[[nodiscard]] ReportSection push_section(const std::string& name, const ComparisonSide& reference,
                                         const ComparisonSide& subject, const Findings& findings);

/// All objects' position errors by phase, phases, corrections, parameters, the papers.
[[nodiscard]] std::vector<ReportSection> closing_sections(const Findings& findings);

/// The figures that say first how good a run is; positions, forces, phases, corrections.
[[nodiscard]] std::vector<Figure> run_headline(const Findings& findings);

[[nodiscard]] ReportSection correction_section(const Findings& findings);

/// Parameters beside the true ones.
[[nodiscard]] ReportSection parameter_section(const Findings& findings);
[[nodiscard]] std::vector<Figure> parameter_headline(const Findings& findings);

/// Rows for position and rotation while touched or moving, and by phase; none without phases.
[[nodiscard]] std::vector<ErrorRow> phase_rows(const std::vector<PoseError>& errors,
                                               const PhaseTimeline& timeline);

/// The parts of run_sections that are lists of words and numbers.
[[nodiscard]] ReportTable settings_table(const RunFindings& run);
[[nodiscard]] ReportTable node_table(const Findings& findings);
[[nodiscard]] ReportTable confusion_table(const PhaseComparison& comparison);
[[nodiscard]] ReportTable correction_table(const Findings& findings);

}  // namespace pcavr
