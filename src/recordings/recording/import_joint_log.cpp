// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/import_joint_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Groups of columns in a file without header, the first that fits: desired values may be left out.
constexpr std::array<std::size_t, 2> kGroups{5, 3};
constexpr std::size_t kMaxJoints = 20;

/// Joints of a row of `columns` numbers without header; 0 where no layout fits.
std::size_t joints_of(std::size_t columns) {
  for (const std::size_t groups : kGroups) {
    if (columns > groups && columns % groups == 1) return columns / groups;
  }
  return 0;
}

std::vector<std::string> numbered(std::size_t joints) {
  std::vector<std::string> names;
  for (std::size_t j = 1; j <= joints; ++j) names.push_back(std::to_string(j));
  return names;
}

Error not_a_number(const fs::path& file, int line, std::string_view text) {
  return {.message = "'" + std::string(text.substr(0, 40)) + "' is not a number in range",
          .file = file.string(),
          .line = line,
          .hint = "write decimal numbers"};
}

std::optional<double> number_in_range(std::string_view text, const InputRange& range) {
  const std::optional<double> number = parse_number(trimmed(text));
  if (!number || !range.contains(*number)) return std::nullopt;
  return number;
}

/// Rows of numbers with the stamp of each.
struct StampedRows {
  std::vector<Stamp> stamps;
  std::vector<int> lines;
  std::vector<std::vector<double>> rows;
  std::size_t left_out = 0;
  std::size_t bad = 0;  // skipped

  /// Leaves out a row that is not after the one before.
  void add(Stamp stamp, int line, std::vector<double> numbers) {
    if (!stamps.empty() && stamp <= stamps.back()) {
      ++left_out;
      return;
    }
    stamps.push_back(stamp);
    lines.push_back(line);
    rows.push_back(std::move(numbers));
  }
};

Eigen::MatrixXd matrix_of(const StampedRows& rows, std::size_t first, std::size_t count) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(rows.rows.size()),
                         static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows.rows[i][first + j];
    }
  }
  return values;
}

ImportedJointLog log_with_stamps(std::vector<std::string> joints, const StampedRows& rows) {
  ImportedJointLog imported;
  imported.left_out = rows.left_out;
  imported.bad = rows.bad;
  imported.log.joints = std::move(joints);
  imported.log.stamps = rows.stamps;
  imported.log.lines = rows.lines;
  for (const Stamp stamp : rows.stamps) {
    imported.log.t.push_back(to_seconds(stamp - rows.stamps.front()));
  }
  return imported;
}

/// The stamp [s] and the joints' numbers of a row without header.
Expected<std::vector<double>> numbers_of(const fs::path& file, int line,
                                         const std::vector<std::string_view>& fields,
                                         std::size_t columns) {
  if (fields.size() != columns || joints_of(columns) == 0) {
    return Error{.message = fmt::format("has {} columns", fields.size()),
                 .file = file.string(),
                 .line = line,
                 .hint = "each row has a stamp and five or three numbers for each joint"};
  }
  std::vector<double> numbers;
  for (const std::string_view field : fields) {
    const InputRange& range = numbers.empty() ? ranges::kStamp : ranges::kJoint;
    const std::optional<double> number = number_in_range(field, range);
    if (!number) return not_a_number(file, line, field);
    numbers.push_back(*number);
  }
  return numbers;
}

Expected<ImportedJointLog> import_without_header(const fs::path& file, const std::string& text,
                                                 bool skip_bad) {
  LineReader lines(text);
  StampedRows rows;
  std::size_t columns = 0;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    const std::vector<std::string_view> fields = split_at(',', *line);
    if (columns == 0) columns = fields.size();
    Expected<std::vector<double>> numbers = numbers_of(file, lines.line(), fields, columns);
    if (!numbers) {
      if (!skip_bad) {
        Error bad = numbers.error();
        bad.hint += ", or skip bad rows by --skip-bad";
        return bad;
      }
      ++rows.bad;
      continue;
    }
    const Stamp stamp = Stamp::from_seconds(numbers->front());
    numbers->erase(numbers->begin());
    rows.add(stamp, lines.line(), *std::move(numbers));
  }
  const std::size_t joints = joints_of(columns);
  ImportedJointLog imported = log_with_stamps(numbered(joints), rows);
  imported.log.position = matrix_of(rows, 0, joints);
  imported.log.velocity = matrix_of(rows, joints, joints);
  imported.log.current = matrix_of(rows, 2 * joints, joints);
  return imported;
}

/// The file of a folder whose name ends so.
std::optional<fs::path> file_ending(const fs::path& folder, std::string_view ending) {
  std::error_code code;
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().filename().string().ends_with(ending)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  if (found.empty()) return std::nullopt;
  return found.front();
}

Expected<std::vector<double>> read_column(const fs::path& file, const InputRange& range) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  LineReader lines(*text);
  std::vector<double> numbers;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    const std::optional<double> number = number_in_range(*line, range);
    if (!number) return not_a_number(file, lines.line(), *line);
    numbers.push_back(*number);
  }
  return numbers;
}

Expected<ImportedJointLog> import_columns(const fs::path& folder) {
  constexpr std::array<std::string_view, 3> kEndings{"positions.txt", "velocity.txt",
                                                     "torques.txt"};
  const std::optional<fs::path> time = file_ending(folder, "time.txt");
  PCAVR_REQUIRE(time.has_value());
  const Expected<std::vector<double>> t = read_column(*time, ranges::kStamp);
  if (!t) return t.error();
  const std::size_t samples = t->size();
  std::array<std::vector<double>, kEndings.size()> values;
  std::size_t joints = 0;
  for (std::size_t k = 0; k < kEndings.size(); ++k) {
    const std::optional<fs::path> file = file_ending(folder, kEndings[k]);
    if (!file) continue;
    Expected<std::vector<double>> numbers = read_column(*file, ranges::kJoint);
    if (!numbers) return numbers.error();
    if (joints == 0 && samples > 0) joints = numbers->size() / samples;
    if (joints == 0 || joints > kMaxJoints || numbers->size() != joints * samples) {
      return Error{.message = fmt::format("has {} numbers for {} stamps", numbers->size(), samples),
                   .file = file->string(),
                   .hint = "each sample has one number for each joint"};
    }
    values[k] = *std::move(numbers);
  }
  StampedRows rows;
  for (std::size_t i = 0; i < samples; ++i) {
    std::vector<double> numbers;
    for (const std::vector<double>& all : values) {
      for (std::size_t j = 0; j < joints && !all.empty(); ++j) {
        numbers.push_back(all[i * joints + j]);
      }
    }
    rows.add(Stamp::from_seconds((*t)[i]), static_cast<int>(i) + 1, std::move(numbers));
  }
  ImportedJointLog imported = log_with_stamps(numbered(joints), rows);
  std::size_t first = 0;
  for (std::size_t k = 0; k < kEndings.size(); ++k) {
    if (values[k].empty()) continue;
    Eigen::MatrixXd& into = k == 0   ? imported.log.position
                            : k == 1 ? imported.log.velocity
                                     : imported.log.torque;
    into = matrix_of(rows, first, joints);
    first += joints;
  }
  return imported;
}

/// Adds a column of stamps to a file with a header, and reads it as joints.csv.
Expected<ImportedJointLog> import_without_stamps(const fs::path& file, const std::string& text,
                                                 const JointLogImportOptions& options) {
  if (!options.period) {
    return Error{.message = "has no column t",
                 .file = file.string(),
                 .line = 1,
                 .hint = "give --period with the time between two rows, as its logger had it"};
  }
  std::string stamped;
  LineReader lines(text);
  std::size_t row = 0;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    stamped += row == 0 ? std::string("t")
                        : format_stamp(Stamp::from_seconds(*options.period * double(row - 1)), 9);
    stamped += ',';
    stamped += *line;
    stamped += '\n';
    ++row;
  }
  Expected<Series<JointLog>> log =
      parse_joint_log({.file = file.string(), .text = stamped, .skip_bad = options.skip_bad});
  if (!log) return log.error();
  return ImportedJointLog{.log = std::move(log->content), .bad = log->report.skipped()};
}

/// The first line of a file that may be a log; empty where it can't be read.
std::string first_line(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return {};
  return text->substr(0, text->find('\n'));
}

}  // namespace

bool has_joint_log(const fs::path& source) {
  std::error_code code;
  if (fs::is_directory(source, code)) {
    return file_ending(source, "positions.txt") && file_ending(source, "time.txt");
  }
  if (source.extension() != ".csv") return false;
  const std::string line = first_line(source);
  const std::vector<std::string_view> fields = split_at(',', line);
  const bool is_numbers = parse_number(fields[0]).has_value();
  return is_numbers ? joints_of(fields.size()) > 0
                    : line.starts_with("q") || line.find(",q_") != line.npos;
}

Expected<ImportedJointLog> import_joint_log(const fs::path& source,
                                            const JointLogImportOptions& options) {
  PCAVR_REQUIRE(!options.period || *options.period > 0.0);
  std::error_code code;
  if (fs::is_directory(source, code)) {
    if (has_joint_log(source)) return import_columns(source);
    return Error{.message = "is not the folder of a joint log",
                 .file = source.string(),
                 .hint = "it has files ending with positions.txt, torques.txt and time.txt"};
  }
  const Expected<std::string> text = read_file(source);
  if (!text) return text.error();
  const std::string line = text->substr(0, text->find('\n'));
  const bool is_numbers = parse_number(split_at(',', line)[0]).has_value();
  Expected<ImportedJointLog> imported = is_numbers
                                            ? import_without_header(source, *text, options.skip_bad)
                                            : import_without_stamps(source, *text, options);
  if (imported && imported->log.t.empty()) {
    return Error{.message = "has no rows", .file = source.string()};
  }
  return imported;
}

}  // namespace pcavr
