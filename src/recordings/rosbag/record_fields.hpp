// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/utf8.hpp"

namespace pcavr {

/// A name from a file as one line of UTF-8, whatever its bytes are.
[[nodiscard]] inline std::string printable_name(std::string_view bytes) {
  std::string name = as_utf8_text(bytes);
  for (char& c : name) {
    if ((c >= 0 && c < ' ') || c == 0x7F) c = '?';
  }
  return name;
}

inline std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads the fields of a bag's record, little-endian.
class RecordFields : public ByteReader {
 public:
  using ByteReader::ByteReader;

  /// The bytes after their length in 32 bits.
  [[nodiscard]] std::span<const std::uint8_t> sized() { return take(integer<std::uint32_t>()); }
  [[nodiscard]] std::string_view text() { return text_of(sized()); }
};

}  // namespace pcavr
