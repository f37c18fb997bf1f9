// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recording/text_rows.hpp"

#include <charconv>
#include <cmath>

namespace pcavr {
namespace {

using Separator = RowFormat::Separator;

constexpr std::string_view kBlanks = " \t";

/// Splits into `fields`, which keeps its memory from row to row.
void split(std::string_view line, Separator separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == Separator::comma) {
    for (;;) {
      const std::size_t comma = line.find(',');
      fields.push_back(trimmed(line.substr(0, comma)));
      if (comma == line.npos) return;
      line.remove_prefix(comma + 1);
    }
  }
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == line.npos) return;
    const std::size_t end = line.find_first_of(kBlanks, begin);
    fields.push_back(line.substr(begin, end - begin));
    if (end == line.npos) return;
    line.remove_prefix(end);
  }
}

std::string joined(const std::vector<std::string>& names, char separator) {
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += separator;
    text += name;
  }
  return text;
}

Error wrong_column_count(const RowFormat& format, std::size_t found) {
  return {.message = "has " + std::to_string(found) + " columns, not " +
                     std::to_string(format.columns.size()),
          .hint = "each line holds " +
                  joined(format.columns, format.separator == Separator::comma ? ',' : ' ')};
}

/// Checks count and stamp, and hands the rest to `take`.
std::optional<Error> take_row(const RowFormat& format, std::span<const std::string_view> fields,
                              std::optional<Stamp>& last, const TakeFields& take) {
  if (fields.size() != format.columns.size()) return wrong_column_count(format, fields.size());
  const Expected<Stamp> stamp = parse_stamp(fields[0]);
  if (!stamp) return stamp.error();
  if (last && *stamp <= *last) {
    return Error{.message = "time " + std::string(fields[0]) + " is not after the one before, " +
                            format_stamp(*last),
                 .hint = "sort the rows by time and keep one of equal ones"};
  }
  if (std::optional<Error> error = take(*stamp, fields.subspan(1))) return error;
  last = *stamp;
  return std::nullopt;
}

}  // namespace

LineReader::LineReader(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end == rest_.npos ? rest_.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++line_;
  return line;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
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

Expected<std::size_t> read_rows(const RowFormat& format, LineReader& lines,
                                const TakeFields& take) {
  std::size_t skipped = 0;
  std::optional<Stamp> last;
  std::vector<std::string_view> fields;
  while (std::optional<std::string_view> line = lines.next()) {
    if (format.separator == Separator::blank) line = line->substr(0, line->find('#'));
    if (trimmed(*line).empty()) continue;
    split(*line, format.separator, fields);
    std::optional<Error> error = take_row(format, fields, last, take);
    if (!error) continue;
    if (!format.skip_bad) {
      error->file = format.file;
      error->line = lines.line();
      return *std::move(error);
    }
    ++skipped;
  }
  return skipped;
}

Expected<std::size_t> read_number_rows(const RowFormat& format, LineReader& lines,
                                       const TakeNumbers& take) {
  std::vector<double> numbers(format.columns.size() - 1);
  return read_rows(format, lines, [&](Stamp stamp, std::span<const std::string_view> fields) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::optional<double> number = parse_number(fields[i]);
      if (!number) {
        return std::optional(
            Error{.message = "'" + std::string(fields[i]) + "' is not a finite number",
                  .place = format.columns[i + 1],
                  .hint = "write a decimal number, or leave the row out"});
      }
      numbers[i] = *number;
    }
    return take(stamp, numbers);
  });
}

Expected<std::vector<std::string>> read_header(const std::string& file, LineReader& lines) {
  const std::optional<std::string_view> line = lines.next();
  if (!line) {
    return Error{.message = "is empty", .file = file, .hint = "begin with the header line"};
  }
  std::vector<std::string_view> names;
  split(*line, Separator::comma, names);
  return std::vector<std::string>(names.begin(), names.end());
}

}  // namespace pcavr
