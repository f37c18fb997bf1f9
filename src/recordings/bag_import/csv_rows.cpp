// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/csv_rows.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/date_time.hpp"

#include "recordings/bag_import/pose_forms.hpp"

namespace pcavr {
namespace fs = std::filesystem;

Expected<CsvRows> CsvRows::open(const fs::path& file, const CsvLayout& layout) {
  Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return CsvRows(file, layout, *std::move(text));
}

CsvRows::CsvRows(const fs::path& file, const CsvLayout& layout, std::string text)
    : file_(&file),
      layout_(&layout),
      text_(std::make_unique<std::string>(std::move(text))),
      lines_(*text_) {
  for (std::size_t i = 0; i < layout.header_lines; ++i) (void)lines_.next();
}

bool CsvRows::next() {
  while (const std::optional<std::string_view> line = lines_.next()) {
    const std::string_view row = trimmed(*line);
    if (row.empty() || row.starts_with('#')) continue;
    fields_ = split_fields(layout_->separator, *line);
    return true;
  }
  return false;
}

Expected<void> CsvRows::check_width() const {
  const std::size_t width = layout_->names.size();
  if (fields_.size() == width) return {};
  return error_at("has " + std::to_string(fields_.size()) + " columns, the header " +
                  std::to_string(width));
}

Expected<double> CsvRows::number(std::size_t column) const {
  const std::optional<double> number = parse_number(fields_[column]);
  if (number) return *number;
  return error_at("'" + fields_[column] + "' is not a finite number (column " +
                  layout_->names[column] + ")");
}

Expected<Stamp> CsvRows::stamp(const CsvLayout::StampColumn& column) const {
  Expected<Stamp> stamp = column.is_date ? date(column) : decimal_stamp(column);
  if (!stamp) return stamp;
  if (layout_->start) *stamp = *layout_->start + Duration(stamp->nanoseconds);
  if (layout_->zone) *stamp = *stamp + -*layout_->zone;
  return stamp;
}

bool CsvRows::is_gap(const CsvLayout::Series& series) const {
  return layout_->has_gaps && std::all_of(series.numbers.begin(), series.numbers.end(),
                                          [&](const CsvLayout::Number& number) {
                                            return fields_[number.column].empty();
                                          });
}

Expected<std::vector<double>> CsvRows::numbers(const CsvLayout::Series& series) const {
  std::vector<double> values;
  for (const CsvLayout::Number& column : series.numbers) {
    const Expected<double> value = number(column.column);
    if (!value) return value.error();
    values.push_back(column.factor * *value);
  }
  MessageNumbers message = message_numbers(series, layout_->is_y_up, std::move(values));
  if (!message.fault.empty()) return error_at(message.fault);
  return std::move(message.values);
}

Error CsvRows::error_at(std::string message) const {
  return {.message = std::move(message),
          .file = file_->string(),
          .line = lines_.line(),
          .hint =
              "write one number for each column of the header; or give --skip-bad to import, "
              "which leaves such rows out"};
}

Expected<Stamp> CsvRows::date(const CsvLayout::StampColumn& column) const {
  const std::optional<DateTime> found = parse_date_time(fields_[column.column]);
  if (found) return found->stamp;
  return error_at("'" + fields_[column.column] + "' is no date with a time of day (column " +
                  layout_->names[column.column] + ")");
}

Expected<Stamp> CsvRows::decimal_stamp(const CsvLayout::StampColumn& column) const {
  const Expected<double> number = this->number(column.column);
  if (!number) return number.error();
  const std::string& text = fields_[column.column];
  Expected<Stamp> stamp = Error{};
  if (column.unit) {
    stamp = parse_stamp(text, *column.unit);
    if (!stamp && *column.unit == TimeUnit::seconds && ranges::kStamp.contains(*number)) {
      stamp = Stamp::from_seconds(*number);  // 1.7e9, or more than nine decimals
    }
  }
  if (stamp && ranges::kStamp.contains(stamp->seconds()) && stamp->nanoseconds >= 0) return stamp;
  Error error = error_at("'" + text +
                         "' is no time in seconds, and none since 1970 in another "
                         "unit");
  error.hint = "name the unit in the header: time_ms, time_us or time_ns";
  return error;
}

}  // namespace pcavr
