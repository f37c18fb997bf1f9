// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "comparison_side.hpp"
#include "findings.hpp"
#include "phase_lanes.hpp"
#include "svg_plot.hpp"

namespace pcavr {

/// One line of the headline: what a busy reader wants to know first, in everyday units.
struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;  ///< "mm", "deg", "ms", "N", "%"; empty for counts
};

/// A list of errors and its figures.
struct ErrorRow {
  std::string name;  ///< "position", "rotation", "ADD", ...
  std::string key;   ///< "absolute.translation", ... in report.json
  std::string unit;  ///< SI: "m", "rad", "N", "s"; empty for shares, which are of 1
  ErrorStatistics figures;
};

/// A figure of report.json that is no list of errors.
struct ReportValue {
  std::string key;  ///< whole, unit at the end
  std::variant<double, std::size_t, std::string> value;
};

/// A table of words and numbers for people.
struct ReportTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows = {};
  std::string note = {};   ///< below it
  bool is_folded = false;  ///< opened by a click: for lists
};

/// One thing that was compared: its errors, and how they look.
struct ReportSection {
  std::string title;
  std::string key;  ///< "camera", "object.NAME.tracked", "mesh"
  std::vector<ErrorRow> rows = {};
  std::vector<Plot> plots = {};
  std::vector<PhaseLane> lanes = {};
  std::vector<ReportTable> tables = {};
  std::vector<ReportValue> values = {};
  std::string note = {};  ///< above all
  bool is_brief = false;  ///< a few columns of the figures, not all of evo's
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

/// 1e3 for mm, ...
inline constexpr double kMillimetres = 1e3;
inline constexpr double kDegrees = 57.29577951308232;
inline constexpr double kPercent = 1e2;

/// report.json: one flat object, SI units in the keys' endings; the headline in everyday units.
[[nodiscard]] std::string format_json(const Report& report, const Findings& findings);

/// report.html: one page with plots inside, that opens without a network.
[[nodiscard]] std::string format_html(const Report& report, const Findings& findings);

}  // namespace pcavr
