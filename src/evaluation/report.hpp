// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "comparison_side.hpp"
#include "findings.hpp"
#include "svg_plot.hpp"

namespace pcavr {

/// One line of the headline: what a busy reader wants to know first, in everyday units.
struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;  ///< "mm", "deg", "%" or empty
};

/// A list of errors and its figures.
struct ErrorRow {
  std::string name;  ///< "position", "rotation", "ADD", ...
  std::string key;   ///< "absolute.translation", ... in report.json
  std::string unit;  ///< SI: "m" or "rad"
  ErrorStatistics figures;
};

/// One thing that was compared: its errors, and how they look.
struct ReportSection {
  std::string title;
  std::string key;  ///< "camera", "object.NAME.tracked", "mesh"
  std::vector<ErrorRow> rows = {};
  std::vector<Plot> plots = {};
};

/// The figures of a comparison, before they are written one way or another.
struct Report {
  std::string subject;
  std::string subject_kind;
  std::string reference;
  std::string reference_kind;
  std::string recording;  ///< empty where it was not found
  std::vector<Figure> headline = {};
  std::vector<ReportSection> sections = {};
};

[[nodiscard]] Report make_report(const ComparisonSide& reference, const ComparisonSide& subject,
                                 const Findings& findings);

/// report.json: one flat object, SI units in the keys' endings; the headline in everyday units.
[[nodiscard]] std::string format_json(const Report& report, const Findings& findings);

/// report.html: one page with plots inside, that opens without a network.
[[nodiscard]] std::string format_html(const Report& report, const Findings& findings);

}  // namespace pcavr
