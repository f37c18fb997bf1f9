// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/report_page.hpp"

/// The JSON text that a report's page shows: inside the page, or alone where the page was not
/// built.
inline std::string report_data(const std::filesystem::path& folder) {
  if (!pcavr::has_report_page()) {
    return pcavr::read_file(folder / pcavr::kReportDataFile).value();
  }
  const std::string page = pcavr::read_file(folder / pcavr::kReportPageFile).value();
  const std::string before = "id=\"report-data\">";
  const std::size_t from = page.find(before) + before.size();
  return page.substr(from, page.find("</script>", from) - from);
}
