// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace pcavr {

inline std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads the fields of a bag's record, little-endian. Past the end it returns zeros and empty
/// values, and is_valid() is false. Never copies.
class RecordFields {
 public:
  explicit RecordFields(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <typename Integer>
  [[nodiscard]] Integer integer() {
    Integer value = 0;
    const std::span<const std::uint8_t> bytes = take(sizeof(Integer));
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(Integer));
    return value;
  }
  [[nodiscard]] std::span<const std::uint8_t> take(std::uint64_t count) {
    if (count > bytes_.size()) {
      is_valid_ = false;
      bytes_ = {};
      return {};
    }
    const std::span<const std::uint8_t> taken = bytes_.first(static_cast<std::size_t>(count));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  /// After their length in 32 bits.
  [[nodiscard]] std::span<const std::uint8_t> sized() { return take(integer<std::uint32_t>()); }
  [[nodiscard]] std::string_view text() { return text_of(sized()); }

  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }
  [[nodiscard]] bool is_valid() const { return is_valid_; }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_valid_ = true;
};

}  // namespace pcavr
