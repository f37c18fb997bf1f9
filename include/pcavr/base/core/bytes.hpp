// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pcavr {

/// Serialises numbers, little-endian, to the end of a buffer, which must outlive the writer.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  template <std::unsigned_integral Integer>
  void integer(Integer value) {
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void f32(float value) { integer(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { integer(std::bit_cast<std::uint64_t>(value)); }

 private:
  std::vector<std::uint8_t>& bytes_;
};

/// Deserialises little-endian numbers, as ByteWriter wrote them. Past the end it returns zeros and
/// empty spans, and is_valid() is false. Never copies.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::unsigned_integral Integer>
  [[nodiscard]] Integer integer() {
    Integer value = 0;
    const std::span<const std::uint8_t> bytes = take(sizeof(Integer));
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value = static_cast<Integer>(value | (static_cast<std::uint64_t>(bytes[i]) << (8 * i)));
    }
    return value;
  }
  [[nodiscard]] float f32() { return std::bit_cast<float>(integer<std::uint32_t>()); }
  [[nodiscard]] double f64() { return std::bit_cast<double>(integer<std::uint64_t>()); }

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

  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }
  [[nodiscard]] bool is_valid() const { return is_valid_; }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_valid_ = true;
};

}  // namespace pcavr
