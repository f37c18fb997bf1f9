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

/// Puts numbers behind each other, little endian, at the end of a buffer that must outlive it.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  template <std::unsigned_integral Whole>
  void whole(Whole value) {
    for (std::size_t i = 0; i < sizeof(Whole); ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void f32(float value) { whole(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { whole(std::bit_cast<std::uint64_t>(value)); }

 private:
  std::vector<std::uint8_t>& bytes_;
};

/// Takes them apart again. Past the end it gives zeros, and is not sound from then on.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::unsigned_integral Whole>
  [[nodiscard]] Whole whole() {
    Whole value = 0;
    if (bytes_.size() < sizeof(Whole)) {
      is_sound_ = false;
      bytes_ = {};
      return value;
    }
    for (std::size_t i = 0; i < sizeof(Whole); ++i) {
      value = static_cast<Whole>(value | (static_cast<std::uint64_t>(bytes_[i]) << (8 * i)));
    }
    bytes_ = bytes_.subspan(sizeof(Whole));
    return value;
  }
  [[nodiscard]] float f32() { return std::bit_cast<float>(whole<std::uint32_t>()); }
  [[nodiscard]] double f64() { return std::bit_cast<double>(whole<std::uint64_t>()); }

  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }
  [[nodiscard]] bool is_sound() const { return is_sound_; }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_sound_ = true;
};

}  // namespace pcavr
