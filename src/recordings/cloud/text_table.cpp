// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "recordings/cloud/scalar_column.hpp"

namespace pcavr {
namespace {

bool is_packed_color(const ScalarColumn& column) {
  return (column.name == "rgb" || column.name == "rgba") && size_of(column.type) == 4;
}

/// Removes the next field of a line; empty at its end.
std::string_view take_field(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  const std::size_t end = std::min(rest.find_first_of(" \t\r", begin), rest.size());
  const std::string_view field = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return field;
}

/// NaN and infinity are numbers here: they mark points without a measurement.
std::optional<double> parse_any_number(std::string_view field) {
  if (field.starts_with('+')) field.remove_prefix(1);
  double number = 0.0;
  const auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (end != field.data() + field.size() || field.empty()) return std::nullopt;
  // Out of a double's range: a denormal, as packed colours are, or far too large.
  if (code == std::errc::result_out_of_range) return 0.0;
  if (code != std::errc{}) return std::nullopt;
  return number;
}

std::uint64_t packed_cell(const ScalarColumn& column, double number) {
  if (column.type == ScalarType::f32) {
    const bool fits = std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max());
    return fits ? std::bit_cast<std::uint32_t>(static_cast<float>(number)) : 0U;
  }
  // Negative where a signed type holds an opaque alpha.
  if (!(std::abs(number) <= 4294967295.0)) return 0U;
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(number));
}

}  // namespace

bool TextTable::add_row(std::string_view line) {
  const std::size_t size = cells_.size();
  for (const ScalarColumn& column : columns_) {
    const std::optional<double> number = parse_any_number(take_field(line));
    if (!number) {
      cells_.resize(size);
      return false;
    }
    cells_.push_back(is_packed_color(column) ? packed_cell(column, *number)
                                             : std::bit_cast<std::uint64_t>(*number));
  }
  if (take_field(line).empty()) return true;
  cells_.resize(size);
  return false;
}

std::span<const ScalarColumn> TextTable::columns() {
  placed_ = columns_;
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    ScalarColumn& column = placed_[i];
    column.type = is_packed_color(columns_[i]) ? ScalarType::u32 : ScalarType::f64;
    column.first = cells_.empty() ? nullptr : reinterpret_cast<const char*>(&cells_[i]);
    column.stride = columns_.size() * sizeof(std::uint64_t);
    column.is_big_endian = false;
  }
  return placed_;
}

}  // namespace pcavr
