// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/report/report_page.hpp"

namespace pcavr {

/// Writes report.html and report.json, which has the same figures, to a folder. `stds` is the
/// footer's sentence: by what the standard deviations are.
[[nodiscard]] Expected<void> write_calibration_report(ReportPage page, const std::string& stds,
                                                      const std::string& json,
                                                      const std::filesystem::path& folder);

}  // namespace pcavr
