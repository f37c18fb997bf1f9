// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace pcavr::mcap {

/// Builds the content of an MCAP record, little-endian.
class RecordText {
 public:
  template <std::unsigned_integral Integer>
  RecordText& integer(Integer value) {
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      bytes_ += static_cast<char>((std::uint64_t{value} >> (8 * i)) & 0xFFU);
    }
    return *this;
  }
  /// Adds the text after its length in 32 bits.
  RecordText& text(std::string_view text) {
    integer(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  RecordText& table(const std::map<std::uint16_t, std::uint64_t>& entries) {
    integer(static_cast<std::uint32_t>(10 * entries.size()));
    for (const auto& [key, value] : entries) integer(key).integer(value);
    return *this;
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// The record with its head: opcode and length.
  [[nodiscard]] std::string record(std::uint8_t opcode) const;

 private:
  std::string bytes_;
};

[[nodiscard]] inline std::string record_head(std::uint8_t opcode, std::uint64_t length) {
  return RecordText().integer(opcode).integer(length).bytes();
}

inline std::string RecordText::record(std::uint8_t opcode) const {
  return record_head(opcode, bytes_.size()) + bytes_;
}

}  // namespace pcavr::mcap
