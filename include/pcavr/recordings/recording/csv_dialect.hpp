// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

// Rows as programs other than pcavr write them. A recording's own files have one dialect
// (text_rows.hpp).

/// The separator of a header's columns: ',', ';', a tab, or a space for any number of them.
[[nodiscard]] char separator_of(std::string_view header);

/// The fields of a line, trimmed, without the quotes around them. A comma that separates decimals
/// becomes a point.
[[nodiscard]] std::vector<std::string> split_fields(char separator, std::string_view line);

/// A column of a header: "Fx [N]" is "fx" in "n", "time_ms" is "time" in "ms"; an index, as in
/// "pose[3]", belongs to the name: "pose_3".
struct CsvColumn {
  std::string name;  ///< lower case; words are joined by '_'
  std::string unit;  ///< lower case, without spaces and dots; empty where none is given
};
[[nodiscard]] CsvColumn parse_column(std::string_view text);

/// A column of a header that was searched by its name.
struct FoundColumn {
  std::size_t column = 0;
  std::string unit;  ///< as CsvColumn has it
};
/// The first column of one of these names, the earlier name first; nullopt where there is none.
[[nodiscard]] std::optional<FoundColumn> find_column(const std::vector<std::string>& header,
                                                     const std::vector<std::string>& names);

/// Decimal units of time; the value is the exponent of ten in a second.
enum class TimeUnit { seconds = 0, milliseconds = 3, microseconds = 6, nanoseconds = 9 };

/// "s", "ms", "us", "ns" and their long names. nullopt for anything else.
[[nodiscard]] std::optional<TimeUnit> parse_time_unit(std::string_view unit);
[[nodiscard]] const char* name_of(TimeUnit unit);

/// Seconds where a number is in their range; else the unit in which it is a time since 1970 in this
/// century. nullopt where there is none.
[[nodiscard]] std::optional<TimeUnit> unit_of_stamp(double number);

/// Exact to the nanosecond for decimal numbers of any size.
[[nodiscard]] Expected<Stamp> parse_stamp(std::string_view text, TimeUnit unit);

}  // namespace pcavr
