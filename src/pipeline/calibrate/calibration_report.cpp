// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration_report.hpp"

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"

namespace pcavr {

Expected<void> write_calibration_report(ReportPage page, const std::string& stds,
                                        const std::string& json,
                                        const std::filesystem::path& folder) {
  page.footer = stds + " The same figures in SI units are in report.json. pcavr " + PCAVR_VERSION;
  const Expected<void> written = write_report_page(page, folder);
  if (!written) return written;
  // By this line --force knows a report of its own.
  nlohmann::ordered_json report{{"format", "pcavr-report/1"}};
  report.update(nlohmann::ordered_json::parse(json));
  return write_file(folder / "report.json", json_text(report, 2));
}

}  // namespace pcavr
