// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pcavr {

/// Serialises to the end of a text by Thrift's compact protocol, as the headers of Parquet are: the
/// part of it that these need [Apache Thrift, thrift-compact-protocol.md]. Fields of a struct in
/// ascending order, at most 15 apart.
class ThriftWriter {
 public:
  enum class Type : std::uint8_t { i32 = 5, i64 = 6, text = 8, list = 9, structure = 12 };

  explicit ThriftWriter(std::string& bytes) : bytes_(bytes) {}

  void i32(int field, std::int32_t value) {
    begin_field(field, Type::i32);
    signed_varint(value);
  }
  void i64(int field, std::int64_t value) {
    begin_field(field, Type::i64);
    signed_varint(value);
  }
  void text(int field, std::string_view value) {
    begin_field(field, Type::text);
    element(value);
  }
  void begin_list(int field, Type of, std::size_t size) {
    begin_field(field, Type::list);
    const auto type = static_cast<std::uint8_t>(of);
    byte(static_cast<std::uint8_t>((size < 15 ? size << 4U : 0xF0U) | type));
    if (size >= 15) varint(size);
  }
  void begin_struct(int field) {
    begin_field(field, Type::structure);
    begin_struct();
  }

  /// Elements of a list; a struct also for the whole, which is no field.
  void element(std::int32_t value) { signed_varint(value); }
  void element(std::string_view value) {
    varint(value.size());
    bytes_ += value;
  }
  void begin_struct() { last_field_.push_back(0); }
  void end_struct() {
    last_field_.pop_back();
    byte(0);
  }

  /// ULEB128.
  void varint(std::uint64_t value) {
    for (; value >= 0x80U; value >>= 7U) byte(static_cast<std::uint8_t>(value | 0x80U));
    byte(static_cast<std::uint8_t>(value));
  }
  void byte(std::uint8_t value) { bytes_ += static_cast<char>(value); }

 private:
  void begin_field(int field, Type type) {
    const int step = field - last_field_.back();
    byte(static_cast<std::uint8_t>((step << 4) | static_cast<int>(type)));
    last_field_.back() = field;
  }
  void signed_varint(std::int64_t value) {  // zigzag
    varint((static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63));
  }

  std::string& bytes_;
  std::vector<int> last_field_;  ///< of the structs that are open
};

}  // namespace pcavr
