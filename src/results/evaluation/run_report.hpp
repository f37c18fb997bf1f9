// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report.hpp"

namespace pcavr {

/// Phases over time, time nodes, settings.
[[nodiscard]] ReportSection overview_section(const Findings& findings);

/// One object's displacement and force over time, and the force's errors.
[[nodiscard]] ReportSection push_section(const std::string& name, const ComparisonSide& reference,
                                         const ComparisonSide& subject, const Findings& findings);

/// All objects' position errors by phase, phases, corrections, parameters, the papers.
[[nodiscard]] std::vector<ReportSection> closing_sections(const Findings& findings);

/// The main metrics of a run: positions, forces, phases, corrections.
[[nodiscard]] std::vector<Metric> run_headline(const Findings& findings);

[[nodiscard]] ReportSection correction_section(const Findings& findings);

/// Identified and true parameters.
[[nodiscard]] ReportSection parameter_section(const Findings& findings);
[[nodiscard]] std::vector<Metric> parameter_headline(const Findings& findings);

/// Rows for position and rotation in contact or moving, and by phase; none without phases.
[[nodiscard]] std::vector<ErrorRow> phase_rows(const std::vector<PoseError>& errors,
                                               const PhaseTimeline& timeline);

/// The tables of a run's sections.
[[nodiscard]] ReportTable settings_table(const RunFindings& run);
[[nodiscard]] ReportTable node_table(const Findings& findings);
[[nodiscard]] ReportTable confusion_table(const PhaseComparison& comparison);
[[nodiscard]] ReportTable correction_table(const Findings& findings);

}  // namespace pcavr
