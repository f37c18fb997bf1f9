// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/csv_layout.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "pcavr/recordings/recording/date_time.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/bag_import/csv_columns.hpp"
#include "recordings/bag_import/motive_layout.hpp"

namespace pcavr {
namespace {

constexpr auto kSensorStamps = std::to_array<std::string_view>(
    {"t_header", "header_stamp", "timestamp", "time_stamp", "time", "stamp", "t"});
constexpr auto kRecorderStamps = std::to_array<std::string_view>({"t_bag", "t_receive"});

std::optional<std::size_t> first_of(const std::vector<CsvColumn>& columns,
                                    std::span<const std::string_view> names) {
  for (const std::string_view name : names) {
    const auto at = std::find_if(columns.begin(), columns.end(),
                                 [&](const CsvColumn& column) { return column.name == name; });
    if (at != columns.end()) return static_cast<std::size_t>(at - columns.begin());
  }
  return std::nullopt;
}

/// Gives the columns the names and units that the user has stated; a column that had such a name
/// loses it.
void rename(const CsvOptions& options, const std::vector<std::string>& names,
            std::vector<CsvColumn>& columns) {
  const std::vector<CsvColumn> written = columns;
  const auto is_meant = [&](std::size_t i, const std::string& name) {
    return names[i] == name || written[i].name == parse_column(name).name;
  };
  for (const auto& [name, column] : options.columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (is_meant(i, column)) {
        columns[i].name = name;
      } else if (columns[i].name == name) {
        columns[i].name.clear();
      }
    }
  }
  for (const auto& [column, unit] : options.units) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].name == column || is_meant(i, column)) {
        columns[i].unit = parse_column("x [" + unit + "]").unit;
      }
    }
  }
}

/// The unit of the header, or that of the number in the first row, or a date.
Expected<CsvLayout::StampColumn> stamp_column(std::size_t column,
                                              const std::vector<CsvColumn>& columns,
                                              const std::vector<std::string>& first_row,
                                              CsvLayout& layout) {
  CsvLayout::StampColumn stamp{.column = column, .unit = TimeUnit::seconds};
  const std::string& unit = columns[column].unit;
  if (!unit.empty()) {
    stamp.unit = parse_time_unit(unit);
    stamp.is_unit_stated = true;
    if (!stamp.unit) return unknown_unit(layout.names[column], unit, "times in s, ms, us or ns");
  } else if (column < first_row.size()) {
    const std::optional<double> number = parse_number(first_row[column]);
    const std::optional<DateTime> date = parse_date_time(first_row[column]);
    stamp.is_date = date.has_value();
    if (date && !date->has_zone) layout.zone = Duration(0);
    if (number) stamp.unit = unit_of_stamp(*number);
  }
  return stamp;
}

}  // namespace

std::optional<std::size_t> stamp_column_of(const std::vector<CsvColumn>& columns) {
  const auto sensor = first_of(columns, kSensorStamps);
  return sensor ? sensor : first_of(columns, kRecorderStamps);
}

Expected<CsvLayout> layout_of(std::string_view text, const CsvOptions& options) {
  const auto motive = motive_layout(text, options);
  if (!motive) return motive.error();
  if (*motive) return **motive;
  LineReader lines(text);
  std::string_view header = trimmed(lines.next().value_or(""));
  const std::string_view first_row = lines.next().value_or("");
  if (header.starts_with('#')) header = trimmed(header.substr(1));
  CsvLayout layout;
  layout.separator = separator_of(header);
  layout.names = split_fields(layout.separator, header);
  std::vector<CsvColumn> columns;
  for (const std::string& name : layout.names) columns.push_back(parse_column(name));
  rename(options, layout.names, columns);
  const auto sensor = first_of(columns, kSensorStamps);
  const auto recorder = first_of(columns, kRecorderStamps);
  if (!sensor && !recorder) return layout;
  auto series = series_of(columns, layout.names, layout.remarks);
  if (!series) return series.error();
  if (series->empty()) return layout;
  const std::vector<std::string> first = split_fields(layout.separator, first_row);
  const auto stamp = stamp_column(sensor ? *sensor : *recorder, columns, first, layout);
  if (!stamp) return stamp.error();
  const auto log_time = stamp_column(recorder ? *recorder : *sensor, columns, first, layout);
  if (!log_time) return log_time.error();
  layout.stamp = *stamp;
  layout.log_time = *log_time;
  layout.series = *std::move(series);
  // A row of several topics has those that had a sample then, as PlotJuggler writes them.
  layout.has_gaps = layout.series.size() > 1;
  return layout;
}

}  // namespace pcavr
