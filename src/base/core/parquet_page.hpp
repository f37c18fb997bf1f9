// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The names and numbers of the file's parts are those of parquet.thrift.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "pcavr/base/core/parquet.hpp"
#include "pcavr/base/core/raw_bytes.hpp"

#include "thrift_writer.hpp"

namespace pcavr::parquet {

enum PhysicalType { kBoolean = 0, kInt64 = 2, kFloat = 4, kDouble = 5, kByteArray = 6 };

template <typename T>
struct IsList : std::false_type {};
template <typename T>
struct IsList<std::vector<T>> : std::true_type {};

/// What the leaves of a column are, by the type of its rows.
struct Shape {
  PhysicalType type = kInt64;
  bool is_text = false;
  bool is_list = false;
  bool is_nullable = false;
};

template <typename T>
constexpr PhysicalType physical_type() {
  if constexpr (std::is_same_v<T, std::int64_t>) return kInt64;
  if constexpr (std::is_same_v<T, double>) return kDouble;
  if constexpr (std::is_same_v<T, float>) return kFloat;
  if constexpr (std::is_same_v<T, bool>) return kBoolean;
  return kByteArray;
}

template <typename Row>
Shape shape_of_rows() {
  if constexpr (IsList<Row>::value) {
    Shape shape = shape_of_rows<typename Row::value_type>();
    shape.is_list = true;
    return shape;
  } else if constexpr (std::is_same_v<Row, std::optional<double>>) {
    return {.type = kDouble, .is_nullable = true};
  } else {
    return {.type = physical_type<Row>(), .is_text = std::is_same_v<Row, std::string>};
  }
}

inline Shape shape_of(const ParquetColumn& column) {
  return std::visit([]<typename Row>(const std::vector<Row>&) { return shape_of_rows<Row>(); },
                    column.values);
}

/// Levels of 0 and 1 as runs of equal ones [Encodings.md, RLE], after their size in bytes.
class LevelRuns {
 public:
  void add(bool level) {
    if (count_ > 0 && level != level_) flush();
    level_ = level;
    ++count_;
  }
  /// Appends to a page; call it once.
  void append_to(std::string& page) {
    flush();
    append_bytes(page, static_cast<std::uint32_t>(runs_.size()));
    page += runs_;
  }

 private:
  void flush() {
    if (count_ == 0) return;
    ThriftWriter writer(runs_);
    writer.varint(count_ << 1U);
    writer.byte(level_ ? 1 : 0);
    count_ = 0;
  }

  std::string runs_;
  bool level_ = false;
  std::uint64_t count_ = 0;
};

/// A page's content, leaf by leaf.
struct Page {
  LevelRuns repetition;  ///< 1: the list of the leaf before goes on
  LevelRuns definition;  ///< 1: there is a value
  std::string values;
  std::uint64_t leaves = 0;  ///< with those that have no value

  template <typename T>
  void add_value(const T& value) {
    append_bytes(values, value);
  }
  void add_value(const std::string& value) {
    append_bytes(values, static_cast<std::uint32_t>(value.size()));
    values += value;
  }

  template <typename T>
  void add_row(const T& value) {
    ++leaves;
    add_value(value);
  }
  void add_row(const std::optional<double>& value) {
    ++leaves;
    definition.add(value.has_value());
    if (value) add_value(*value);
  }
  template <typename T>
  void add_row(const std::vector<T>& list) {
    leaves += list.empty() ? 1 : list.size();
    repetition.add(false);
    definition.add(!list.empty());
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (i > 0) {
        repetition.add(true);
        definition.add(true);
      }
      add_value(list[i]);
    }
  }
  template <typename Row>
  void add_rows(const std::vector<Row>& rows) {
    for (const Row& row : rows) add_row(row);
  }
  /// Eight to a byte, the first in the lowest bit.
  void add_rows(const std::vector<bool>& rows) {
    leaves = rows.size();
    values.assign((rows.size() + 7) / 8, '\0');
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i]) values[i / 8] = static_cast<char>(values[i / 8] | (1 << (i % 8)));
    }
  }

  [[nodiscard]] std::string bytes(const Shape& shape) {
    std::string all;
    if (shape.is_list) repetition.append_to(all);
    if (shape.is_list || shape.is_nullable) definition.append_to(all);
    return all + values;
  }
};

}  // namespace pcavr::parquet
