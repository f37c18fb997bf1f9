// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/core/utf8.hpp"

#include <bit>
#include <cstddef>

namespace pcavr {
namespace {

bool is_character(char32_t point) noexcept {
  const bool is_surrogate = point >= 0xd800 && point <= 0xdfff;
  const bool is_noncharacter = (point & 0xfffe) == 0xfffe || (point >= 0xfdd0 && point <= 0xfdef);
  return point <= 0x10ffff && !is_surrogate && !is_noncharacter;
}

}  // namespace

bool is_utf8_text(std::string_view bytes) noexcept {
  constexpr char32_t kMinCodePoint[] = {0, 0, 0x80, 0x800, 0x10000};
  while (!bytes.empty()) {
    const auto lead = static_cast<unsigned char>(bytes.front());
    const auto ones = static_cast<std::size_t>(std::countl_one(lead));
    const std::size_t length = ones == 0 ? 1 : ones;
    if (ones == 1 || length > 4 || length > bytes.size()) return false;
    char32_t point = lead & (0xffU >> (ones + 1));
    for (const char next : bytes.substr(1, length - 1)) {
      const auto byte = static_cast<unsigned char>(next);
      if ((byte & 0xc0U) != 0x80U) return false;
      point = (point << 6U) | (byte & 0x3fU);
    }
    if (point < kMinCodePoint[length] || !is_character(point)) return false;
    bytes.remove_prefix(length);
  }
  return true;
}

std::string as_utf8_text(std::string_view bytes) {
  if (is_utf8_text(bytes)) return std::string(bytes);
  std::string text;
  for (const char c : bytes) {
    if (static_cast<unsigned char>(c) < 0x80) {
      text += c;
    } else {
      text += "\xEF\xBF\xBD";
    }
  }
  return text;
}

}  // namespace pcavr
