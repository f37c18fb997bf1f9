// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/report_page.hpp"

#include <string_view>

#include "pcavr/base/core/output.hpp"

#include "page_template.hpp"

namespace pcavr {

bool has_report_page() { return page_template().find(kDataPlace) != std::string_view::npos; }

std::string how_to_open(const std::filesystem::path& report_folder) {
  if (has_report_page()) {
    return "open " + (report_folder / kReportPageFile).string() + " in a browser";
  }
  return "no " + std::string(kReportPageFile) + ", only its data in " +
         (report_folder / kReportDataFile).string() +
         ": pcavr was built without the report's page; run scripts/build-page and build again";
}

Expected<void> write_report_page(const ReportPage& page, const std::filesystem::path& folder) {
  const std::string data = format_report_data(page);
  if (!has_report_page()) return write_file(folder / kReportDataFile, data);
  std::string html(page_template());
  html.replace(html.find(kDataPlace), kDataPlace.size(), data);
  return write_file(folder / kReportPageFile, html);
}

}  // namespace pcavr
