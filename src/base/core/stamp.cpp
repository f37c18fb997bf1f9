// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/stamp.hpp"

#include <cmath>
#include <limits>

namespace pcavr {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
/// Keeps every stamp, and every difference of two, inside 64 bits (about 146 years either side).
constexpr std::int64_t kMaxSeconds =
    std::numeric_limits<std::int64_t>::max() / 2 / kNanosecondsPerSecond;

Error not_a_stamp(std::string_view text) {
  return {.message = "'" + std::string(text) + "' is not a time",
          .hint = "write decimal seconds with at most nine decimals, such as 12.033333"};
}

}  // namespace

Stamp Stamp::from_seconds(double seconds) {
  PCAVR_REQUIRE(std::isfinite(seconds) && std::abs(seconds) < double(kMaxSeconds), seconds);
  const double whole = std::floor(seconds);
  return {static_cast<std::int64_t>(whole) * kNanosecondsPerSecond +
          std::llround((seconds - whole) * 1e9)};
}

Expected<Stamp> parse_stamp(std::string_view text) {
  std::string_view rest = text;
  const bool negative = rest.starts_with('-');
  if (negative) rest.remove_prefix(1);
  const std::size_t dot = rest.find('.');
  const std::string_view whole = rest.substr(0, dot);
  const std::string_view decimals = dot == rest.npos ? std::string_view() : rest.substr(dot + 1);
  if (whole.empty() || decimals.size() > 9) return not_a_stamp(text);

  std::int64_t seconds = 0;
  for (const char c : whole) {
    if (c < '0' || c > '9' || seconds > kMaxSeconds / 10) return not_a_stamp(text);
    seconds = seconds * 10 + (c - '0');
  }
  if (seconds > kMaxSeconds) return not_a_stamp(text);
  std::int64_t fraction = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const char c = i < decimals.size() ? decimals[i] : '0';
    if (c < '0' || c > '9') return not_a_stamp(text);
    fraction = fraction * 10 + (c - '0');
  }
  const std::int64_t total = seconds * kNanosecondsPerSecond + fraction;
  return Stamp{negative ? -total : total};
}

std::string format_stamp(Stamp stamp, int decimals) {
  PCAVR_REQUIRE(decimals >= 0 && decimals <= 9, decimals);
  std::uint64_t unit = 1;
  for (int i = decimals; i < 9; ++i) unit *= 10;
  const bool negative = stamp.nanoseconds < 0;
  // Unsigned: that of the smallest stamp, and of the largest rounded up, has no signed number.
  const auto bits = static_cast<std::uint64_t>(stamp.nanoseconds);
  const std::uint64_t magnitude = negative ? 0 - bits : bits;
  const std::uint64_t rounded = (magnitude + unit / 2) / unit * unit;
  constexpr std::uint64_t kSecond = kNanosecondsPerSecond;
  std::string text = (negative && rounded > 0 ? "-" : "") + std::to_string(rounded / kSecond);
  if (decimals > 0) {
    const std::string nine = std::to_string(kSecond + rounded % kSecond);
    text += '.' + nine.substr(1, static_cast<std::size_t>(decimals));
  }
  return text;
}

}  // namespace pcavr
