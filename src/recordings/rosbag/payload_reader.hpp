// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/rosbag/record_fields.hpp"

namespace pcavr {

/// Reads the fields of a message in ROS 1 serialization (packed, little-endian), or in CDR (aligned
/// to their size from the end of the 4-byte header). Past the end it returns zeros and empty
/// values, and is_valid() is false.
class PayloadReader {
 public:
  /// Largest length of the name of a frame, a joint or an encoding [bytes]: each is kept and
  /// printed.
  static constexpr std::uint32_t kMaxName = 1U << 16;

  PayloadReader(std::span<const std::uint8_t> payload, bool is_cdr)
      : bytes_(payload), is_cdr_(is_cdr) {
    if (is_cdr) read_cdr_header();
  }

  [[nodiscard]] bool is_cdr() const { return is_cdr_; }
  [[nodiscard]] bool is_valid() const { return is_valid_; }

  /// An integer or floating-point number.
  template <typename Number>
  [[nodiscard]] Number number() {
    if (is_cdr_) align(sizeof(Number));
    const std::span<const std::uint8_t> taken = take(sizeof(Number));
    if (taken.empty()) return Number{};
    std::array<std::uint8_t, sizeof(Number)> raw{};
    std::copy(taken.begin(), taken.end(), raw.begin());
    if (is_big_endian_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }
  /// A name; one beyond kMaxName is not valid.
  [[nodiscard]] std::string text() {
    const auto size = number<std::uint32_t>();
    if (size > kMaxName) {
      invalidate();
      return {};
    }
    std::string_view text = text_of(take(size));
    if (is_cdr_ && !text.empty() && text.back() == '\0') text.remove_suffix(1);
    return std::string(text);
  }
  /// A sequence of bytes; a view of the payload.
  [[nodiscard]] std::span<const std::uint8_t> byte_sequence() {
    return take(number<std::uint32_t>());
  }
  /// The length of a sequence whose items take at least `item_size` bytes each.
  [[nodiscard]] std::size_t length(std::size_t item_size) {
    const auto count = number<std::uint32_t>();
    if (count * item_size <= bytes_.size() - at_) return count;
    invalidate();
    return 0;
  }
  [[nodiscard]] std::vector<double> double_sequence() {
    std::vector<double> values(length(sizeof(double)));
    for (double& value : values) value = number<double>();
    return values;
  }

 private:
  /// Plain CDR (0, 1) or CDR of version 2 (6, 7), which aligns to at most 4 bytes; odd numbers are
  /// little-endian.
  void read_cdr_header() {
    if (bytes_.size() < 4 || bytes_[0] != 0) return invalidate();
    const std::uint8_t representation = bytes_[1];
    if (representation != 0 && representation != 1 && representation != 6 && representation != 7) {
      return invalidate();
    }
    is_big_endian_ = representation % 2 == 0;
    max_alignment_ = representation >= 6 ? 4 : 8;
    bytes_ = bytes_.subspan(4);
  }

  void align(std::size_t size) {
    const std::size_t alignment = std::min(size, max_alignment_);
    const std::size_t padding = (alignment - at_ % alignment) % alignment;
    (void)take(padding);
  }

  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > bytes_.size() - at_) {
      invalidate();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }

  void invalidate() {
    is_valid_ = false;
    bytes_ = {};
    at_ = 0;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::size_t max_alignment_ = 8;
  bool is_cdr_ = false;
  bool is_big_endian_ = false;
  bool is_valid_ = true;
};

}  // namespace pcavr
