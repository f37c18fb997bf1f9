// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/evaluation/evaluate.hpp"

#include "pcavr/core/output.hpp"

#include "comparison_side.hpp"
#include "findings.hpp"
#include "report.hpp"

namespace pcavr {

Expected<std::string> evaluate(const EvaluationInput& input,
                               const std::filesystem::path& report_folder, Parallelism parallelism,
                               const Observer& observer) {
  const Expected<ComparisonSide> subject = read_side(input.subject);
  if (!subject) return subject.error();
  const Expected<ComparisonSide> reference = read_side(input.reference);
  if (!reference) return reference.error();

  const Expected<Findings> findings = compare(*reference, *subject, parallelism, observer);
  if (!findings) return findings.error();
  const Report report = make_report(*reference, *subject, *findings);

  const std::string json = format_json(report, *findings);
  Expected<void> written = write_file(report_folder / "report.json", json);
  if (!written) return written.error();
  written = write_file(report_folder / "report.html", format_html(report, *findings));
  if (!written) return written.error();
  return json;
}

}  // namespace pcavr
