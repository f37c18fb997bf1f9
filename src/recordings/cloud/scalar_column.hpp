// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/recordings/cloud/cloud_file.hpp"

namespace pcavr {

enum class ScalarType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

[[nodiscard]] std::size_t size_of(ScalarType type);

/// One property of all points: numbers of one type at a constant distance in memory.
struct ScalarColumn {
  std::string name;
  ScalarType type = ScalarType::f32;
  const char* first = nullptr;
  std::size_t stride = 0;  ///< [bytes]
  bool is_big_endian = false;

  [[nodiscard]] double value(std::size_t row) const;
  /// The four bytes of a type of 32 bits: packed colours.
  [[nodiscard]] std::uint32_t packed_bits(std::size_t row) const;
};

/// The numbers of a text, row by row, for columns: eight bytes each.
class TextTable {
 public:
  explicit TextTable(std::vector<ScalarColumn> columns) : columns_(std::move(columns)) {}

  /// Appends a row; false where it has not one number for each column. Packed colours (rgb, rgba)
  /// are stored as their bits, of a float's or of a whole number's.
  [[nodiscard]] bool add_row(std::string_view line);
  /// The columns, with their places in memory; valid until the next row is added.
  [[nodiscard]] std::span<const ScalarColumn> columns();
  [[nodiscard]] std::size_t rows() const {
    return columns_.empty() ? 0 : cells_.size() / columns_.size();
  }

 private:
  std::vector<ScalarColumn> columns_;  ///< with the types of the header
  std::vector<ScalarColumn> placed_;
  std::vector<std::uint64_t> cells_;
};

[[nodiscard]] const ScalarColumn* find_column(std::span<const ScalarColumn> columns,
                                              std::string_view name);

/// The points, normals and colours of the columns; an Error without file where x, y or z is
/// missing. Width and height are those of an unorganised cloud.
[[nodiscard]] Expected<RecordedCloud> cloud_of_columns(std::span<const ScalarColumn> columns,
                                                       std::size_t count);

}  // namespace pcavr
