// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/bag_import/pose_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/date_time.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/bag_import/csv_columns.hpp"
#include "recordings/bag_import/csv_layout.hpp"
#include "recordings/bag_import/pose_forms.hpp"
#include "recordings/bag_import/pose_numbers.hpp"

namespace pcavr {
namespace {

constexpr auto kViewNumbers = std::to_array<std::string_view>(
    {"index", "view", "number", "id", "frame", "image", "pose", "nr", "no", "n", "i"});
constexpr double kMaxViewNumber = 1e6;  ///< whole numbers up to it may count views

/// Where the columns of a table are.
struct PoseColumns {
  char separator = ',';
  std::size_t width = 0;
  std::vector<std::string> names = {};  ///< empty: there is no header
  std::optional<std::size_t> stamp = {}, number = {};
  std::optional<TimeUnit> time_unit = {};
  CsvLayout::Series series = {};         ///< by the header
  PoseForm form = PoseForm::quaternion;  ///< without a header
  std::size_t first = 0;                 ///< column of the pose, without a header
  bool is_unit_stated = false;           ///< of lengths
  std::vector<std::string> remarks = {};
};

bool is_content(std::string_view line) {
  const std::string_view row = trimmed(line);
  return !row.empty() && !row.starts_with('#');
}

std::optional<std::vector<double>> all_numbers(const std::vector<std::string>& fields) {
  std::vector<double> numbers;
  for (const std::string& field : fields) {
    const std::optional<double> number = parse_number(field);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// Takes off what all names end with: "_tool" of x_tool, y_tool, qx_tool.
void remove_common_ending(std::vector<CsvColumn>& columns) {
  const std::string& first = columns.front().name;
  const std::size_t at = first.rfind('_');
  if (at == first.npos) return;
  const std::string ending = first.substr(at);
  const bool is_common = std::all_of(columns.begin(), columns.end(), [&](const CsvColumn& column) {
    return column.name.size() > ending.size() && column.name.ends_with(ending);
  });
  if (!is_common) return;
  for (CsvColumn& column : columns) column.name.resize(column.name.size() - ending.size());
}

Expected<CsvLayout::Series> pose_series(const std::vector<CsvColumn>& columns,
                                        const std::vector<std::string>& names,
                                        std::vector<std::string>& remarks) {
  Expected<CsvLayout::Series> vector = rotation_vector_series(columns, names);
  const auto found = series_of(columns, names, remarks);
  if (!found) return found.error();
  for (const CsvLayout::Series& series : *found) {
    if (series.type == "geometry_msgs/PoseStamped") return series;
  }
  return vector;
}

Expected<PoseColumns> columns_of_header(char separator, std::vector<std::string> names) {
  PoseColumns layout{.separator = separator, .width = names.size()};
  std::vector<CsvColumn> columns;
  for (const std::string& name : names) columns.push_back(parse_column(name));
  Expected<CsvLayout::Series> series = pose_series(columns, names, layout.remarks);
  if (series && series->numbers.empty()) {
    remove_common_ending(columns);
    series = pose_series(columns, names, layout.remarks);
  }
  if (!series) return series.error();
  if (series->numbers.empty()) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return Error{.message = "has no columns of a pose: " + list,
                 .line = 1,
                 .hint =
                     "name them t (or index), x, y, z, qx, qy, qz, qw, or x, y, z, rx, ry, rz "
                     "for a rotation vector"};
  }
  layout.stamp = stamp_column_of(columns);
  if (layout.stamp) layout.time_unit = parse_time_unit(columns[*layout.stamp].unit);
  for (const std::string_view name : kViewNumbers) {
    const auto at = std::find_if(columns.begin(), columns.end(),
                                 [&](const CsvColumn& column) { return column.name == name; });
    if (layout.number || at == columns.end()) continue;
    layout.number = static_cast<std::size_t>(at - columns.begin());
  }
  layout.series = *std::move(series);
  layout.names = std::move(names);
  layout.is_unit_stated = !columns[layout.series.numbers.front().column].unit.empty() ||
                          layout.series.form == RowForm::angles_zyx;
  return layout;
}

/// Whether the last four numbers are a quaternion, as nearly no other numbers are.
bool ends_with_quaternion(const std::vector<double>& numbers) {
  constexpr double kTolerance = 1e-2;
  double square = 0.0;
  for (std::size_t i = numbers.size() - 4; i < numbers.size(); ++i)
    square += numbers[i] * numbers[i];
  return std::abs(square - 1.0) < kTolerance;
}

/// The layout of a table without a header, by its first row. Whether the column before the pose has
/// stamps or the views' numbers is decided by all rows.
Expected<PoseColumns> columns_of_row(char separator, const std::vector<double>& row) {
  PoseColumns layout{.separator = separator, .width = row.size()};
  std::optional<PoseForm> form = form_of_count(row.size());
  const bool is_ambiguous = row.size() == 7;  // or a stamp before a rotation vector
  if (!form || (is_ambiguous && !ends_with_quaternion(row))) {
    form = form_of_count(row.size() - 1);
    layout.first = 1;
    layout.stamp = 0;
  }
  if (form) {
    layout.form = *form;
    return layout;
  }
  return Error{.message = fmt::format("has {} columns, of which no pose is known", row.size()),
               .line = 1,
               .hint = "give t, x, y, z, qx, qy, qz, qw, or name the columns in a header"};
}

Expected<PoseColumns> find_columns(std::string_view text) {
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (!is_content(*line)) continue;
    const char separator = separator_of(*line);
    std::vector<std::string> fields = split_fields(separator, *line);
    const std::optional<std::vector<double>> numbers = all_numbers(fields);
    return numbers ? columns_of_row(separator, *numbers)
                   : columns_of_header(separator, std::move(fields));
  }
  return Error{.message = "has no rows", .hint = "give a table of poses"};
}

Expected<Stamp> stamp_of(const std::string& text, std::optional<TimeUnit> unit) {
  if (const std::optional<DateTime> date = parse_date_time(text)) return date->stamp;
  const std::optional<double> number = parse_number(text);
  if (number && !unit) unit = unit_of_stamp(*number);
  if (number && unit) {
    const Expected<Stamp> exact = parse_stamp(text, *unit);
    const double seconds = *number / std::pow(10.0, static_cast<int>(*unit));
    if (exact) return exact;
    if (ranges::kStamp.contains(seconds)) return Stamp::from_seconds(seconds);
  }
  return Error{.message = "'" + text + "' is no time",
               .hint = "give seconds, or name the unit in the header: time_ms, time_us, time_ns"};
}

/// The rows of a table, as they are read.
class TableReader {
 public:
  TableReader(std::string file, PoseColumns layout, const PoseListOptions& options)
      : file_(std::move(file)), layout_(std::move(layout)), options_(options) {}

  Expected<PoseList> read(std::string_view text) {
    LineReader lines(text);
    bool is_header = !layout_.names.empty();
    while (const std::optional<std::string_view> line = lines.next()) {
      if (!is_content(*line)) continue;
      if (std::exchange(is_header, false)) continue;
      Expected<ListedPose> pose = read_row(split_fields(layout_.separator, *line));
      if (pose) {
        pose->file = file_;
        pose->line = lines.line();
        list_.poses.push_back(*std::move(pose));
        continue;
      }
      Error error = pose.error();
      error.file = file_;
      error.line = lines.line();
      if (!options_.skip_bad) return error;
      if (skipped_++ == 0) first_skipped_ = error;
    }
    finish();
    return std::move(list_);
  }

 private:
  Expected<ListedPose> read_row(const std::vector<std::string>& fields) const {
    if (fields.size() != layout_.width) {
      return Error{
          .message = fmt::format("has {} columns, the {} {}", fields.size(),
                                 layout_.names.empty() ? "first row" : "header", layout_.width),
          .hint =
              "the file may have been cut while it was written; --skip-bad leaves such "
              "rows out"};
    }
    ListedPose listed;
    listed.number = static_cast<int>(list_.poses.size());
    if (layout_.stamp) {
      const Expected<Stamp> stamp = stamp_of(fields[*layout_.stamp], layout_.time_unit);
      if (!stamp) return stamp.error();
      listed.stamp = *stamp;
    } else if (layout_.number) {
      const std::optional<double> number = parse_number(fields[*layout_.number]);
      if (number && std::abs(*number) < kMaxViewNumber) listed.number = static_cast<int>(*number);
    }
    Expected<Pose> pose = layout_.names.empty() ? pose_by_count(fields) : pose_by_header(fields);
    if (!pose) return pose.error();
    listed.pose = *pose;
    return listed;
  }

  Expected<double> number_at(const std::vector<std::string>& fields, std::size_t column) const {
    const std::optional<double> number = parse_number(fields[column]);
    if (number) return *number;
    return Error{.message = fmt::format(
                     "'{}' is not a finite number (column {})", fields[column],
                     layout_.names.empty() ? std::to_string(column + 1) : layout_.names[column]),
                 .hint = "--skip-bad leaves such rows out"};
  }

  Expected<Pose> pose_by_header(const std::vector<std::string>& fields) const {
    std::vector<double> values;
    for (const CsvLayout::Number& column : layout_.series.numbers) {
      const Expected<double> value = number_at(fields, column.column);
      if (!value) return value.error();
      values.push_back(column.factor * *value);
    }
    if (layout_.series.form == RowForm::rotation_vector) {
      return pose_of_numbers(PoseForm::rotation_vector, values, false);
    }
    MessageNumbers message = message_numbers(layout_.series, false, std::move(values));
    if (!message.fault.empty()) return Error{.message = message.fault};
    return pose_of_numbers(PoseForm::quaternion, message.values, options_.is_w_first);
  }

  Expected<Pose> pose_by_count(const std::vector<std::string>& fields) const {
    std::vector<double> values;
    for (std::size_t i = layout_.first; i < fields.size(); ++i) {
      const Expected<double> value = number_at(fields, i);
      if (!value) return value.error();
      values.push_back(*value);
    }
    return pose_of_numbers(layout_.form, values, options_.is_w_first);
  }

  /// Whether the column before the pose counts the views: whole numbers, each one more.
  [[nodiscard]] bool counts_views() const {
    if (!layout_.names.empty() || layout_.first == 0 || list_.poses.empty()) return false;
    for (std::size_t i = 0; i < list_.poses.size(); ++i) {
      const double number = list_.poses[i].stamp->seconds();
      if (number != std::floor(number) || std::abs(number) > kMaxViewNumber) return false;
      if (i > 0 && number != list_.poses[i - 1].stamp->seconds() + 1.0) return false;
    }
    return true;
  }

  void finish() {
    if (counts_views()) {
      for (ListedPose& pose : list_.poses) {
        pose.number = static_cast<int>(pose.stamp->seconds());
        pose.stamp.reset();
      }
    }
    const char* form = name_of(layout_.form);
    if (!layout_.names.empty() && layout_.series.form == RowForm::rotation_vector) {
      form = name_of(PoseForm::rotation_vector);
    } else if (!layout_.names.empty() && layout_.series.form == RowForm::angles_zyx) {
      form = "turns about z, y, x";
    }
    list_.format = fmt::format("{} rows{}, {}", list_.poses.size(),
                               list_.has_stamps() ? " with stamps" : "", form);
    list_.notes = layout_.remarks;
    if (skipped_ == 0) return;
    list_.notes.push_back(fmt::format("{} {} left out, the first: line {} {}", skipped_,
                                      skipped_ == 1 ? "row is" : "rows are", first_skipped_.line,
                                      first_skipped_.message));
  }

  std::string file_;
  PoseColumns layout_;
  PoseListOptions options_;
  PoseList list_;
  std::size_t skipped_ = 0;
  Error first_skipped_;
};

}  // namespace

Expected<PosesInFileUnit> read_pose_table(const std::filesystem::path& file,
                                          const PoseListOptions& options) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<PoseColumns> layout = find_columns(*text);
  if (!layout) {
    Error error = layout.error();
    error.file = file.string();
    return error;
  }
  const bool is_unit_stated = layout->is_unit_stated;
  Expected<PoseList> list = TableReader(file.string(), *std::move(layout), options).read(*text);
  if (!list) return list.error();
  return PosesInFileUnit{*std::move(list), is_unit_stated};
}

}  // namespace pcavr
