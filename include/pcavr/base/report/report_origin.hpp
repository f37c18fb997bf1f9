// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace pcavr {

/// How a program's reports were made.
struct ReportOrigin {
  std::string command = {};  ///< as it can be given to a shell; empty: not shown
  std::string date = {};     ///< empty: not shown
};

/// That of a command line: its words, quoted where a shell needs it, and the time now, in UTC to the
/// minute, or that of SOURCE_DATE_EPOCH [reproducible-builds.org], for reports that are the same at
/// each run.
[[nodiscard]] ReportOrigin origin_of_command(std::span<char* const> words);

/// Of all reports that are written from now on; without it, they have none. Call it before the
/// program has threads.
void set_report_origin(ReportOrigin origin);
[[nodiscard]] const ReportOrigin& report_origin();

}  // namespace pcavr
