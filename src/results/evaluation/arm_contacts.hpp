// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "findings.hpp"
#include "report.hpp"

namespace pcavr {

/// Adds the torques at the arm's joints by each contact, of the measured wrench and of the rendered
/// force along the same direction. Adds nothing if the recording has no arm with logged joints.
[[nodiscard]] Expected<void> add_joint_loads(const std::filesystem::path& recording,
                                             const ForceErrorOptions& options, RunFindings& run);

/// Paper B's contact experiments as the arm did them: rows for the table of published results, with
/// its columns. Nothing where the contacts are not an arm's.
void add_arm_rows(const RunFindings& run, ReportTable& table);

/// The joint that each contact loads most; without rows where the contacts are not an arm's.
[[nodiscard]] ReportTable joint_load_table(const RunFindings& run, Stamp origin);

}  // namespace pcavr
