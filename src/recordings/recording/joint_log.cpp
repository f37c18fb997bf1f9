// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/joint_log.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/input_ranges.hpp"

namespace pcavr {
namespace {

constexpr int kNotRecorded = -1;
constexpr int kStampDecimals = 9;

struct Quantity {
  std::string_view prefix;
  Eigen::MatrixXd JointLog::*values;
};
constexpr auto kQuantities = std::to_array<Quantity>({{"q", &JointLog::position},
                                                      {"dq", &JointLog::velocity},
                                                      {"tau", &JointLog::torque},
                                                      {"current", &JointLog::current}});

/// The joint of a column `PREFIX_NAME` or `PREFIXnumber`; nullopt where it is another column.
std::optional<std::string> joint_of(std::string_view column, std::string_view prefix) {
  if (!column.starts_with(prefix) || column.size() == prefix.size()) return std::nullopt;
  column.remove_prefix(prefix.size());
  if (column.starts_with("_ext_")) return std::nullopt;
  if (column.front() == '_') {
    column.remove_prefix(1);
    if (column.empty()) return std::nullopt;
    return std::string(column);
  }
  const bool is_number = std::all_of(column.begin(), column.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
  if (!is_number) return std::nullopt;
  return std::string(column);
}

/// The column of each joint for each quantity, without the stamp's.
struct ColumnMap {
  std::vector<std::string> joints;
  std::array<std::vector<int>, kQuantities.size()> columns;
  std::vector<std::string> unused;
};

Error header_error(std::string message, std::string place = {}) {
  return Error{.message = std::move(message),
               .line = 1,
               .place = std::move(place),
               .hint =
                   "the columns are t, and q_NAME, dq_NAME, tau_NAME or current_NAME for each "
                   "joint NAME; all but q may be absent"};
}

/// Assigns a column that isn't a position; false where it is none of the quantities.
Expected<bool> assign(const std::string& name, int column, ColumnMap& map) {
  for (std::size_t k = 1; k < kQuantities.size(); ++k) {
    const std::optional<std::string> joint = joint_of(name, kQuantities[k].prefix);
    if (!joint) continue;
    const auto found = std::find(map.joints.begin(), map.joints.end(), *joint);
    if (found == map.joints.end()) {
      return header_error(fmt::format("no position column for joint '{}'", *joint), name);
    }
    int& place = map.columns[k][static_cast<std::size_t>(found - map.joints.begin())];
    if (place != kNotRecorded) return header_error("the column occurs twice", name);
    place = column;
    return true;
  }
  return false;
}

std::optional<Error> incomplete(const ColumnMap& map) {
  for (std::size_t k = 1; k < kQuantities.size(); ++k) {
    const std::vector<int>& columns = map.columns[k];
    const auto missing = std::find(columns.begin(), columns.end(), kNotRecorded);
    const auto count = std::count(columns.begin(), columns.end(), kNotRecorded);
    if (count == 0 || count == static_cast<std::ptrdiff_t>(columns.size())) continue;
    const std::string& joint = map.joints[static_cast<std::size_t>(missing - columns.begin())];
    return header_error(fmt::format("the header has no column {}_{}, but has it for other joints",
                                    kQuantities[k].prefix, joint));
  }
  return std::nullopt;
}

Expected<ColumnMap> map_columns(const std::vector<std::string>& names) {
  if (names.empty() || names[0] != "t") return header_error("the header's first column is not 't'");
  ColumnMap map;
  for (std::size_t i = 1; i < names.size(); ++i) {
    const std::optional<std::string> joint = joint_of(names[i], "q");
    if (!joint) continue;
    if (std::find(map.joints.begin(), map.joints.end(), *joint) != map.joints.end()) {
      return header_error("the column occurs twice", names[i]);
    }
    map.joints.push_back(*joint);
    map.columns[0].push_back(static_cast<int>(i) - 1);
  }
  if (map.joints.empty()) return header_error("the header has no position column, q_NAME");
  for (std::size_t k = 1; k < kQuantities.size(); ++k) {
    map.columns[k].assign(map.joints.size(), kNotRecorded);
  }
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (joint_of(names[i], "q")) continue;
    const Expected<bool> assigned = assign(names[i], static_cast<int>(i) - 1, map);
    if (!assigned) return assigned.error();
    if (!*assigned) map.unused.push_back(names[i]);
  }
  if (const std::optional<Error> error = incomplete(map)) return *error;
  return map;
}

struct LogRows {
  std::vector<Stamp> stamps;
  std::vector<int> lines;
  std::vector<double> numbers;  ///< row by row
};

/// The stamps relative to the first, and the numbers by quantity and joint.
JointLog log_of(ColumnMap map, const LogRows& rows, std::size_t width) {
  JointLog log;
  log.joints = std::move(map.joints);
  log.lines = rows.lines;
  log.unused = std::move(map.unused);
  for (const Stamp stamp : rows.stamps) {
    log.t.push_back(to_seconds(stamp - rows.stamps.front()));
  }
  log.stamps = rows.stamps;
  const auto count = static_cast<Eigen::Index>(rows.stamps.size());
  for (std::size_t k = 0; k < kQuantities.size(); ++k) {
    const std::vector<int>& columns = map.columns[k];
    if (columns.front() == kNotRecorded) continue;
    Eigen::MatrixXd& values = log.*kQuantities[k].values;
    values.resize(count, static_cast<Eigen::Index>(columns.size()));
    for (Eigen::Index row = 0; row < count; ++row) {
      for (std::size_t j = 0; j < columns.size(); ++j) {
        values(row, static_cast<Eigen::Index>(j)) =
            rows.numbers[static_cast<std::size_t>(row) * width +
                         static_cast<std::size_t>(columns[j])];
      }
    }
  }
  return log;
}

}  // namespace

Expected<Series<JointLog>> parse_joint_log(const SeriesText& text) {
  LineReader lines(text.text);
  const Expected<std::vector<std::string>> header = read_header(text.file, lines);
  if (!header) return header.error();
  Expected<ColumnMap> map = map_columns(*header);
  if (!map) {
    Error error = map.error();
    error.file = text.file;
    return error;
  }
  const RowFormat format{text.file, RowFormat::Separator::comma, *header, text.skip_bad};
  LogRows rows;
  const auto handle = [&](Stamp stamp, std::span<const double> numbers) -> std::optional<RowFault> {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      std::optional<Error> error = check_range(ranges::kJoint, numbers[i]);
      if (!error) continue;
      error->place = format.columns[i + 1];
      return RowFault(*std::move(error), "number out of range");
    }
    rows.stamps.push_back(stamp);
    rows.lines.push_back(lines.line());
    rows.numbers.insert(rows.numbers.end(), numbers.begin(), numbers.end());
    return std::nullopt;
  };
  Expected<RowReport> report = read_number_rows(format, lines, handle);
  if (!report) return report.error();
  return Series<JointLog>{log_of(*std::move(map), rows, header->size() - 1), *std::move(report)};
}

std::string format_joint_log(const JointLog& log) {
  std::string text = "t";
  for (const Quantity& quantity : kQuantities) {
    if ((log.*quantity.values).rows() == 0) continue;
    for (const std::string& joint : log.joints) {
      text += fmt::format(",{}_{}", quantity.prefix, joint);
    }
  }
  text += '\n';
  for (std::size_t row = 0; row < log.t.size(); ++row) {
    text += format_stamp(log.stamps[row], kStampDecimals);
    for (const Quantity& quantity : kQuantities) {
      const Eigen::MatrixXd& values = log.*quantity.values;
      if (values.rows() == 0) continue;
      for (Eigen::Index j = 0; j < values.cols(); ++j) {
        text += fmt::format(",{}", values(static_cast<Eigen::Index>(row), j));
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace pcavr
