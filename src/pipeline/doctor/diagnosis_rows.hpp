// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/pipeline/doctor.hpp"

namespace pcavr {

/// Makes rows of each verdict.
[[nodiscard]] DiagnosisRow agreement(std::string what, std::string figure);
[[nodiscard]] DiagnosisRow disagreement(std::string what, std::string figure, std::string cause);
[[nodiscard]] DiagnosisRow unchecked(std::string what, std::string reason);
/// The disagreement of a file that can't be read.
[[nodiscard]] DiagnosisRow row_of(const Error& error);

/// Rates, gaps, repeated values and clocks of all streams, and the range of the tool and the
/// joints.
[[nodiscard]] std::vector<DiagnosisRow> stream_rows(const Recording& recording);

/// The tool's weight in the force, by its orientations; and the arm's joints against its tool.
[[nodiscard]] std::vector<DiagnosisRow> arm_rows(const Recording& recording);

/// The objects' CAD files and the robot's description. `findings` are known of them already.
[[nodiscard]] std::vector<DiagnosisRow> body_rows(const Recording& recording,
                                                  const PerceptionOptions& options,
                                                  const std::vector<ConsistencyFinding>& findings);

}  // namespace pcavr
