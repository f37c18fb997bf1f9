// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

using Duration = std::chrono::nanoseconds;

/// A timestamp on the recording's common clock, in integer nanoseconds, so that stamps compare
/// exactly.
struct Stamp {
  std::int64_t nanoseconds = 0;

  auto operator<=>(const Stamp&) const = default;

  /// The stamp in seconds, for formulas and files; exact to 0.2 us for stamps of this century.
  [[nodiscard]] double seconds() const { return static_cast<double>(nanoseconds) * 1e-9; }
  [[nodiscard]] static Stamp from_seconds(double seconds);
};

[[nodiscard]] inline Duration operator-(Stamp later, Stamp earlier) {
  return Duration(later.nanoseconds - earlier.nanoseconds);
}
[[nodiscard]] inline Stamp operator+(Stamp stamp, Duration duration) {
  return {stamp.nanoseconds + duration.count()};
}
[[nodiscard]] inline double to_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}
/// The duration, rounded to the nearest nanosecond.
[[nodiscard]] inline Duration duration_from_seconds(double seconds) {
  return Stamp::from_seconds(seconds) - Stamp();
}

/// Reads decimal seconds ("1305031480.050000", up to nine decimals) without rounding.
[[nodiscard]] Expected<Stamp> parse_stamp(std::string_view text);

/// Decimal seconds with `decimals` (0 to 9) places, as parse_stamp reads them.
[[nodiscard]] std::string format_stamp(Stamp stamp, int decimals = 6);

}  // namespace pcavr
