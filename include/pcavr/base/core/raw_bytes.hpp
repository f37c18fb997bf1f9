// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

namespace pcavr {

// PLY and glTF files are little-endian; values are copied as in memory.
static_assert(std::endian::native == std::endian::little);

template <typename Value>
void append_bytes(std::string& bytes, const Value& value) {
  static_assert(std::is_arithmetic_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(Value));
}

/// The value at `offset`; no bounds check.
template <typename Value>
[[nodiscard]] Value load_value(const char* bytes, std::size_t offset) {
  static_assert(std::is_arithmetic_v<Value>);
  Value value;
  std::memcpy(&value, bytes + offset, sizeof(Value));
  return value;
}

}  // namespace pcavr
