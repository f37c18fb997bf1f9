// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/report/plot.hpp"

namespace pcavr {

/// A table of texts and numbers for people; a column's unit is in its heading.
struct ReportTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows = {};
  std::string note = {};   ///< below it
  bool is_folded = false;  ///< collapsed on screen: for long lists
};

/// Part of a line of text.
struct PageSpan {
  std::string text;
  bool is_strong = false;
};

struct PageText {
  std::string text;
  bool is_highlighted = false;
};

/// Plots side by side; a map is as high as the two charts next to it.
struct PlotGroup {
  std::string title;  ///< may be empty
  std::vector<Plot> plots = {};
};

struct PagePicture {
  std::string title;
  std::string jpeg;       ///< the file's bytes
  std::string note = {};  ///< below it
};

using PageBlock =
    std::variant<PageText, PagePicture, PlotGroup, LaneChart, std::vector<ReportTable>>;

struct PageSection {
  std::string title;
  std::vector<PageBlock> blocks = {};  ///< from top to bottom
};

/// The content of a report, independent of its appearance: texts, tables and the data of plots.
struct ReportPage {
  std::string title;
  std::string heading;
  std::vector<std::vector<PageSpan>> inputs = {};  ///< lines below the heading
  std::vector<std::string> notes = {};             ///< highlighted
  std::string verdict = {};                        ///< what was found, in a sentence or two
  /// The main metrics, the most important first: the page folds those after the fifth. May have no
  /// rows.
  ReportTable headline = {};
  std::vector<PageSection> sections = {};
  std::string footer = {};
};

inline constexpr char kReportPageFile[] = "report.html";
inline constexpr char kReportDataFile[] = "report_data.json";

/// Whether this library contains the report's page, which npm builds (apps/viewer): built without
/// it, reports are data only.
[[nodiscard]] bool has_report_page();

/// One line for the user: which file of a report to open, or why there is none.
[[nodiscard]] std::string how_to_open(const std::filesystem::path& report_folder);

/// The page's content as JSON. The same page and command (report_command.hpp) give the same bytes.
/// Coordinates are rounded to a hundred-thousandth of their axis' range or less.
[[nodiscard]] std::string format_report_data(const ReportPage& page);

/// Writes report.html: one file with script, style and data inside, which opens without a network.
/// Without the page (has_report_page) it writes report_data.json instead. The folder exists.
[[nodiscard]] Expected<void> write_report_page(const ReportPage& page,
                                               const std::filesystem::path& folder);

}  // namespace pcavr
