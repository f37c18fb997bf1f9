// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/text_rows.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

namespace pcavr {
namespace {

using Separator = RowFormat::Separator;

constexpr std::string_view kWhitespace = " \t";

void split_at_whitespace(std::string_view line, std::vector<std::string_view>& fields) {
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kWhitespace);
    if (begin == line.npos) return;
    const std::size_t end = line.find_first_of(kWhitespace, begin);
    fields.push_back(line.substr(begin, end - begin));
    if (end == line.npos) return;
    line.remove_prefix(end);
  }
}

/// Splits one row after the other into fields; reuses its memory.
class RowFields {
 public:
  /// False where the line is empty or a comment.
  [[nodiscard]] bool split(std::string_view line, Separator separator) {
    fields_.clear();
    if (separator == Separator::comma) {
      if (trimmed(line).empty()) return false;
      split_at(',', line, fields_);
      return true;
    }
    // Quotes are rare: without them a row needs no copy.
    if (line.substr(0, line.find('#')).find_first_of("\"\\") != line.npos) {
      split_quoted(line);
    } else {
      split_at_whitespace(line.substr(0, line.find('#')), fields_);
    }
    return !fields_.empty();
  }
  [[nodiscard]] std::span<const std::string_view> all() const { return fields_; }

 private:
  /// "..." and a backslash quote whitespace, '#', quotes and backslashes.
  void split_quoted(std::string_view line) {
    unquoted_.clear();
    std::string field;
    bool is_quoted = false;
    bool has_field = false;
    const auto finish = [&] {
      if (has_field) unquoted_.push_back(field);
      field.clear();
      has_field = false;
    };
    for (std::size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      if (c == '\\' && i + 1 < line.size()) {
        field += line[++i];
        has_field = true;
      } else if (c == '"') {
        is_quoted = !is_quoted;
        has_field = true;
      } else if (!is_quoted && c == '#') {
        break;
      } else if (!is_quoted && kWhitespace.find(c) != kWhitespace.npos) {
        finish();
      } else {
        field += c;
        has_field = true;
      }
    }
    finish();
    fields_.assign(unquoted_.begin(), unquoted_.end());
  }

  std::vector<std::string_view> fields_;
  std::vector<std::string> unquoted_;
};

std::string joined(const std::vector<std::string>& names, char separator) {
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += separator;
    text += name;
  }
  return text;
}

RowFault wrong_column_count(const RowFormat& format, std::size_t found) {
  return {{.message = "has " + std::to_string(found) + " columns, not " +
                      std::to_string(format.columns.size()),
           .hint = "each line has the columns " +
                   joined(format.columns, format.separator == Separator::comma ? ',' : ' ')},
          "wrong number of columns"};
}

/// Checks the number of columns and the stamp, and passes the rest to `handle`.
std::optional<RowFault> handle_row(const RowFormat& format,
                                   std::span<const std::string_view> fields,
                                   std::optional<Stamp>& last, const FieldsHandler& handle) {
  if (fields.size() != format.columns.size()) return wrong_column_count(format, fields.size());
  const Expected<Stamp> stamp = parse_stamp(fields[0]);
  if (!stamp) return RowFault(stamp.error(), "not a time");
  if (last && *stamp <= *last) {
    return RowFault(Error{.message = "time " + std::string(fields[0]) +
                                     " is not after the previous one, " + format_stamp(*last),
                          .hint = "sort the rows by time and remove duplicates"},
                    "time is not after the one before");
  }
  if (std::optional<RowFault> fault = handle(*stamp, fields.subspan(1))) return fault;
  last = *stamp;
  return std::nullopt;
}

/// Detects a truncated last line: one without a line end and shorter than each of the lines just
/// before it. Those at the start of a recording may be much shorter: zeros.
class TruncationDetector {
 public:
  void add(const LineReader& lines, std::string_view line) {
    const auto shortest = std::min_element(sizes_.begin(), sizes_.begin() + known_);
    if (!lines.has_line_end() && known_ > 0 && line.size() < *shortest) short_line_ = lines.line();
    std::rotate(sizes_.rbegin(), sizes_.rbegin() + 1, sizes_.rend());
    sizes_.front() = line.size();
    known_ = std::min(known_ + 1, std::ssize(sizes_));
  }
  [[nodiscard]] std::optional<int> short_line() const { return short_line_; }

 private:
  std::array<std::size_t, 8> sizes_{};  ///< of the lines before, newest first
  std::ptrdiff_t known_ = 0;
  std::optional<int> short_line_;
};

}  // namespace

LineReader::LineReader(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  has_line_end_ = end != rest_.npos;
  rest_.remove_prefix(has_line_end_ ? end + 1 : rest_.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++line_;
  return line;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kWhitespace);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kWhitespace) - begin + 1);
}

void split_at(char separator, std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t end = line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == line.npos) return;
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> split_at(char separator, std::string_view line) {
  std::vector<std::string_view> fields;
  split_at(separator, line, fields);
  return fields;
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) {
    return std::nullopt;
  }
  return number;
}

void RowReport::count_skipped(const std::string& reason) {
  const auto known = std::find_if(left_out.begin(), left_out.end(),
                                  [&](const auto& entry) { return entry.first == reason; });
  if (known == left_out.end()) {
    left_out.emplace_back(reason, 1);
  } else {
    ++known->second;
  }
}

std::size_t RowReport::skipped() const {
  std::size_t sum = 0;
  for (const auto& [reason, count] : left_out) sum += count;
  return sum;
}

Expected<RowReport> read_rows(const RowFormat& format, LineReader& lines,
                              const FieldsHandler& handle) {
  RowReport report;
  TruncationDetector truncation;
  std::optional<Stamp> last;
  RowFields fields;
  while (std::optional<std::string_view> line = lines.next()) {
    if (!fields.split(*line, format.separator)) continue;
    truncation.add(lines, *line);
    std::optional<RowFault> fault = handle_row(format, fields.all(), last, handle);
    if (!fault) continue;
    if (!format.skip_bad) {
      fault->error.file = format.file;
      fault->error.line = lines.line();
      return std::move(fault->error);
    }
    report.count_skipped(fault->reason);
  }
  report.short_last_line = truncation.short_line();
  return report;
}

Expected<RowReport> read_number_rows(const RowFormat& format, LineReader& lines,
                                     const NumbersHandler& handle) {
  std::vector<double> numbers(format.columns.size() - 1);
  return read_rows(
      format, lines,
      [&](Stamp stamp, std::span<const std::string_view> fields) -> std::optional<RowFault> {
        for (std::size_t i = 0; i < fields.size(); ++i) {
          const std::optional<double> number = parse_number(fields[i]);
          if (!number) {
            return RowFault(
                Error{.message = "'" + std::string(fields[i]) + "' is not a finite number",
                      .place = format.columns[i + 1],
                      .hint = "write a decimal number, or remove the row"},
                "not a finite number");
          }
          numbers[i] = *number;
        }
        return handle(stamp, numbers);
      });
}

Expected<std::vector<std::string>> read_header(const std::string& file, LineReader& lines) {
  const std::optional<std::string_view> line = lines.next();
  if (!line) {
    return Error{.message = "is empty", .file = file, .hint = "begin with the header line"};
  }
  const std::vector<std::string_view> names = split_at(',', *line);
  return std::vector<std::string>(names.begin(), names.end());
}

}  // namespace pcavr
