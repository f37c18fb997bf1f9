// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/csv_dialect.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {
namespace {

constexpr std::string_view kBlank = " \t";

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// The characters of a line that are not inside quotes.
std::string without_quoted(std::string_view line) {
  std::string rest;
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted) rest += c;
  }
  return rest;
}

/// "0,25" is 0.25: a comma in a field separates no columns.
void use_decimal_point(std::string& field) {
  const std::size_t comma = field.find(',');
  if (comma == field.npos) return;
  std::string number = field;
  number[comma] = '.';
  if (parse_number(number)) field = std::move(number);
}

/// Units as they end a name: "time_ms", "x_mm".
constexpr auto kUnitEndings =
    std::to_array<std::string_view>({"s", "sec", "secs", "seconds", "ms", "us", "ns", "m", "cm",
                                     "mm", "n", "kn", "nm", "nmm", "ncm", "deg", "rad"});

/// Lower case, without spaces, dots and signs of multiplication; a Greek mu is a u.
std::string plain_unit(std::string_view text) {
  constexpr auto kMu = std::to_array<std::string_view>({"\xC2\xB5", "\xCE\xBC"});
  std::string unit;
  while (!text.empty()) {
    const auto mu = std::find_if(kMu.begin(), kMu.end(),
                                 [&](std::string_view sign) { return text.starts_with(sign); });
    if (mu != kMu.end()) {
      unit += 'u';
      text.remove_prefix(mu->size());
      continue;
    }
    const char c = text.front();
    text.remove_prefix(1);
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '%') unit += lower(c);
  }
  return unit;
}

bool is_whole_number(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
}

/// Lower case; anything between words becomes one '_'.
std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += lower(c);
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  if (name.ends_with('_')) name.pop_back();
  return name;
}

}  // namespace

char separator_of(std::string_view header) {
  const std::string names = without_quoted(header);
  constexpr std::array<char, 3> kSeparators{';', '\t', ','};
  const auto found = std::find_if(kSeparators.begin(), kSeparators.end(),
                                  [&](char c) { return names.find(c) != names.npos; });
  return found == kSeparators.end() ? ' ' : *found;
}

std::vector<std::string> split_fields(char separator, std::string_view line) {
  const bool by_blanks = separator == ' ';
  if (by_blanks) line = trimmed(line);
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      is_quoted = !is_quoted;
      continue;
    }
    const bool is_end = !is_quoted && (by_blanks ? kBlank.find(c) != kBlank.npos : c == separator);
    if (!is_end) {
      fields.back() += c;
    } else if (!by_blanks || !fields.back().empty()) {
      fields.emplace_back();
    }
  }
  for (std::string& field : fields) {
    field = trimmed(field);
    use_decimal_point(field);
  }
  return fields;
}

CsvColumn parse_column(std::string_view text) {
  CsvColumn column;
  const std::size_t open = text.find_last_of("[(");
  const std::size_t close = text.find_last_of("])");
  const bool has_bracket = open != text.npos && open > 0 && close == trimmed(text).size() - 1;
  if (has_bracket && is_whole_number(text.substr(open + 1, close - open - 1))) {
    column.name = plain_name(text.substr(0, open)) + '_' +
                  std::string(text.substr(open + 1, close - open - 1));
    return column;
  }
  if (has_bracket) {
    column.unit = plain_unit(text.substr(open + 1, close - open - 1));
    text = text.substr(0, open);
  }
  column.name = plain_name(text);
  const std::size_t last = column.name.rfind('_');
  if (has_bracket || last == column.name.npos) return column;
  const std::string ending = column.name.substr(last + 1);
  if (std::find(kUnitEndings.begin(), kUnitEndings.end(), ending) == kUnitEndings.end()) {
    return column;
  }
  column.unit = ending;
  column.name.resize(last);
  return column;
}

std::optional<FoundColumn> find_column(const std::vector<std::string>& header,
                                       const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    for (std::size_t i = 0; i < header.size(); ++i) {
      const CsvColumn column = parse_column(header[i]);
      if (column.name == name) return FoundColumn{i, column.unit};
    }
  }
  return std::nullopt;
}

std::optional<TimeUnit> parse_time_unit(std::string_view unit) {
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), unit) != names.end();
  };
  if (is_one_of({"s", "sec", "secs", "second", "seconds"})) return TimeUnit::seconds;
  if (is_one_of({"ms", "msec", "millisecond", "milliseconds"})) return TimeUnit::milliseconds;
  if (is_one_of({"us", "usec", "microsecond", "microseconds"})) return TimeUnit::microseconds;
  if (is_one_of({"ns", "nsec", "nanosecond", "nanoseconds"})) return TimeUnit::nanoseconds;
  return std::nullopt;
}

const char* name_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::milliseconds:
      return "milliseconds";
    case TimeUnit::microseconds:
      return "microseconds";
    case TimeUnit::nanoseconds:
      return "nanoseconds";
    case TimeUnit::seconds:
      break;
  }
  return "seconds";
}

std::optional<TimeUnit> unit_of_stamp(double number) {
  constexpr double kFirstEpoch = 946'684'800.0;  // [s] 2000-01-01
  if (ranges::kStamp.contains(number)) return TimeUnit::seconds;
  for (const TimeUnit unit :
       {TimeUnit::milliseconds, TimeUnit::microseconds, TimeUnit::nanoseconds}) {
    const double seconds = number / std::pow(10.0, static_cast<int>(unit));
    if (seconds >= kFirstEpoch && ranges::kStamp.contains(seconds)) return unit;
  }
  return std::nullopt;
}

Expected<Stamp> parse_stamp(std::string_view text, TimeUnit unit) {
  const bool is_negative = text.starts_with('-');
  if (is_negative) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const auto shift = static_cast<std::size_t>(unit);
  std::string digits(text.substr(0, point));
  if (digits.size() <= shift) digits.insert(0, shift + 1 - digits.size(), '0');
  const std::size_t whole = digits.size() - shift;
  if (point < text.size()) digits += text.substr(point + 1);
  constexpr std::size_t kDecimals = 9;  // of a nanosecond: those after it are cut
  const std::string seconds = (is_negative ? "-" : "") + digits.substr(0, whole);
  return parse_stamp(seconds + '.' + digits.substr(whole, kDecimals));
}

}  // namespace pcavr
