// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pcavr/base/report/report_page.hpp"

#include "comparison_side.hpp"
#include "findings.hpp"

namespace pcavr {

/// One line of the headline: the main metrics, in common units.
struct Metric {
  std::string name;
  double value = 0.0;
  std::string unit;  ///< "mm", "deg", "ms", "N", "%"; empty for counts
};

/// The statistics of a list of errors.
struct ErrorRow {
  std::string name;  ///< "position", "rotation", "ADD", ...
  std::string key;   ///< "absolute.translation", ... in report.json
  std::string unit;  ///< SI: "m", "rad", "N", "s"; empty for ratios
  ErrorStatistics stats;
};

/// A single value of report.json.
struct ReportValue {
  std::string key;  ///< complete, unit at the end
  std::variant<double, std::size_t, std::string> value;
};

/// One compared item: its errors, plots and tables.
struct ReportSection {
  std::string title;
  std::string key;  ///< "camera", "object.NAME.tracked", "mesh"
  std::vector<ErrorRow> rows = {};
  std::vector<PagePicture> pictures = {};
  std::vector<Plot> plots = {};
  std::vector<Lane> lanes = {};
  std::vector<ReportTable> tables = {};
  std::vector<ReportValue> values = {};
  std::string note = {};  ///< above all
  bool is_brief = false;  ///< main statistics only, not all of evo's
};

/// The results of a comparison, independent of the output format.
struct Report {
  std::string subject;
  std::string subject_kind;
  std::string reference;
  std::string reference_kind;
  std::string recording;                                                ///< empty where not found
  std::vector<std::pair<std::string, std::string>> configuration = {};  ///< as in EvaluationInput
  std::vector<Metric> headline = {};
  std::vector<ReportSection> sections = {};
};

[[nodiscard]] Report make_report(const ComparisonSide& reference, const ComparisonSide& subject,
                                 const Findings& findings);

/// 1e3 for mm, ...
inline constexpr double kMillimetres = 1e3;
inline constexpr double kDegrees = 57.29577951308232;
inline constexpr double kPercent = 1e2;

/// File in the report's folder: the mesh coloured by its distance from the reference.
inline constexpr char kErrorMeshFile[] = "mesh_errors.ply";

/// report.json: one flat object, keys end in their SI unit; the headline in common units.
[[nodiscard]] std::string format_json(const Report& report, const Findings& findings);

/// The same for people, with plots.
[[nodiscard]] ReportPage evaluation_page(const Report& report, const Findings& findings);

}  // namespace pcavr
