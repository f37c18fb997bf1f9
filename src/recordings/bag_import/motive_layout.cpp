// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/motive_layout.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/recordings/recording/date_time.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/bag_import/csv_columns.hpp"

namespace pcavr {
namespace {

using Row = std::vector<std::string>;

// The header ends with the row of axes; before it come at most six rows, and empty lines.
constexpr int kMaxHeaderLines = 12;

/// The values of the first row, which has names and values by turns.
std::map<std::string, std::string> properties_of(const Row& row) {
  std::map<std::string, std::string> properties;
  for (std::size_t i = 0; i + 1 < row.size(); i += 2) properties.emplace(row[i], row[i + 1]);
  return properties;
}

std::optional<double> metres_of(const std::string& unit) {
  constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{
      {{"Meters", 1.0}, {"Centimeters", 1e-2}, {"Millimeters", 1e-3}}};
  const auto* known = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const auto& entry) { return entry.first == unit; });
  if (known == kUnits.end()) return std::nullopt;
  return known->second;
}

/// The rows of the header that name each column.
struct ColumnRows {
  Row kinds;       ///< "Rigid Body", "Marker", ...
  Row names;       ///< of the bodies
  Row quantities;  ///< "Rotation", "Position", ...
  Row axes;        ///< "Frame", "Time (Seconds)", "X", ...

  [[nodiscard]] static const std::string& at(const Row& row, std::size_t column) {
    static const std::string kNone;
    return column < row.size() ? row[column] : kNone;
  }
  [[nodiscard]] std::optional<std::size_t> find(const std::string& body, std::string_view quantity,
                                                std::string_view axis) const {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (at(kinds, i) == "Rigid Body" && at(names, i) == body && at(quantities, i) == quantity &&
          axes[i] == axis) {
        return i;
      }
    }
    return std::nullopt;
  }
  /// In the order of their columns.
  [[nodiscard]] std::vector<std::string> bodies() const {
    std::vector<std::string> found;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const std::string& name = at(names, i);
      if (kinds[i] != "Rigid Body" || name.empty()) continue;
      if (std::find(found.begin(), found.end(), name) == found.end()) found.push_back(name);
    }
    return found;
  }
};

Error unfit(std::string message, std::string hint) {
  return {.message = std::move(message), .line = 1, .hint = std::move(hint)};
}

Expected<CsvLayout::Series> series_of_body(const ColumnRows& rows, const std::string& body,
                                           double metres) {
  CsvLayout::Series series{.type = kTrackedBodyType, .name = body};
  const auto add = [&](const char* quantity, const char* axis, double factor) {
    const auto column = rows.find(body, quantity, axis);
    if (column) series.numbers.push_back({*column, factor});
  };
  for (const char* axis : {"X", "Y", "Z"}) add("Position", axis, metres);
  for (const char* axis : {"X", "Y", "Z", "W"}) add("Rotation", axis, 1.0);
  if (series.numbers.size() != 7) {
    return unfit("rigid body '" + body + "' has no position and rotation in quaternions",
                 "export the take with Rotation Type Quaternion and rigid bodies");
  }
  return series;
}

}  // namespace

Expected<std::optional<CsvLayout>> motive_layout(std::string_view text, const CsvOptions& options) {
  LineReader lines(text);
  const Row first = split_fields(',', lines.next().value_or(""));
  if (first.front() != "Format Version") return std::optional<CsvLayout>();
  const std::map<std::string, std::string> properties = properties_of(first);
  const auto property = [&](const char* name) {
    const auto at = properties.find(name);
    return at == properties.end() ? std::string() : at->second;
  };
  if (property("Rotation Type") != "Quaternion") {
    return unfit("the take's Rotation Type is '" + property("Rotation Type") + "'",
                 "export it with Rotation Type Quaternion");
  }
  const std::optional<double> metres = metres_of(property("Length Units"));
  if (!metres) {
    return unfit("the take's Length Units are '" + property("Length Units") + "'",
                 "export it in Meters, Centimeters or Millimeters");
  }
  ColumnRows rows;
  CsvLayout layout;
  std::vector<Row> header;
  while (header.size() < kMaxHeaderLines) {
    const std::optional<std::string_view> line = lines.next();
    if (!line) break;
    header.push_back(split_fields(',', *line));
    if (header.back().front() == "Frame") break;
  }
  // Kinds, names, identifiers, quantities, axes; newer formats have the parents between.
  if (header.size() < 5 || header.back().front() != "Frame" || header.back().size() < 3) {
    return unfit("the take's header has no row of axes that begins with 'Frame'",
                 "export it with its header");
  }
  rows.axes = header.back();
  rows.quantities = header[header.size() - 2];
  for (const Row& row : header) {
    const bool has_kinds = std::find(row.begin(), row.end(), "Rigid Body") != row.end();
    if (rows.kinds.empty() && has_kinds) {
      rows.kinds = row;
    } else if (!rows.kinds.empty() && rows.names.empty()) {
      rows.names = row;
    }
  }
  for (const std::string& body : rows.bodies()) {
    auto series = series_of_body(rows, body, *metres);
    if (!series) return series.error();
    layout.series.push_back(*std::move(series));
  }
  if (layout.series.empty()) {
    return unfit("the take has no rigid bodies", "export it with rigid bodies");
  }
  layout.header_lines = static_cast<std::size_t>(lines.line());
  layout.names = rows.axes;
  layout.stamp = {.column = 1, .unit = TimeUnit::seconds, .is_unit_stated = true};
  layout.log_time = layout.stamp;
  if (const auto start = parse_date_time(property("Capture Start Time"))) {
    layout.start = start->stamp;
    if (!start->has_zone) layout.zone = Duration(0);
  }
  layout.is_y_up = options.up.value_or('y') == 'y';
  if (!options.up) {
    layout.remarks.emplace_back("y is taken as up, as Motive exports; --up z if it is not");
  }
  layout.is_take = layout.has_gaps = true;
  return std::optional(std::move(layout));
}

}  // namespace pcavr
