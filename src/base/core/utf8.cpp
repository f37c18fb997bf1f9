// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/utf8.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdio>
#include <optional>

namespace pcavr {
namespace {

bool is_character(char32_t point) noexcept {
  const bool is_surrogate = point >= 0xd800 && point <= 0xdfff;
  const bool is_noncharacter = (point & 0xfffe) == 0xfffe || (point >= 0xfdd0 && point <= 0xfdef);
  return point <= 0x10ffff && !is_surrogate && !is_noncharacter;
}

struct Character {
  char32_t point;
  std::size_t length;  ///< bytes
};

/// nullopt where `bytes`, not empty, do not begin with a valid one.
std::optional<Character> first_character(std::string_view bytes) noexcept {
  constexpr char32_t kMinCodePoint[] = {0, 0, 0x80, 0x800, 0x10000};
  const auto lead = static_cast<unsigned char>(bytes.front());
  const auto ones = static_cast<std::size_t>(std::countl_one(lead));
  const std::size_t length = ones == 0 ? 1 : ones;
  if (ones == 1 || length > 4 || length > bytes.size()) return std::nullopt;
  char32_t point = lead & (0xffU >> (ones + 1));
  for (const char next : bytes.substr(1, length - 1)) {
    const auto byte = static_cast<unsigned char>(next);
    if ((byte & 0xc0U) != 0x80U) return std::nullopt;
    point = (point << 6U) | (byte & 0x3fU);
  }
  if (point < kMinCodePoint[length] || !is_character(point)) return std::nullopt;
  return Character{point, length};
}

/// Whether a terminal acts on it instead of showing it, or shows what follows in another order:
/// controls of C0 (except the tab) and C1, of the line and of the direction of writing.
bool is_control(char32_t point) noexcept {
  const auto is_in = [point](char32_t first, char32_t last) {
    return point >= first && point <= last;
  };
  return (point < 0x20 && point != '\t') || is_in(0x7f, 0x9f) || point == 0x061c ||
         point == 0x200b || is_in(0x200e, 0x200f) || is_in(0x2028, 0x202e) ||
         is_in(0x2060, 0x206f) || point == 0xfeff || is_in(0xfff9, 0xfffb) ||
         is_in(0xe0000, 0xe007f);
}

/// The code point as a C++ escape: "\\x1b", "\\u202e".
std::string escaped(char32_t point) {
  std::array<char, 16> text{};
  const char* const format = point < 0x100 ? "\\x%02x" : point < 0x10000 ? "\\u%04x" : "\\U%08x";
  std::snprintf(text.data(), text.size(), format, static_cast<unsigned>(point));
  return text.data();
}

/// The last bytes, up to `max`, that do not begin within a character: up to three bytes of one are
/// left out.
std::string_view end_of(std::string_view text, std::size_t max) {
  std::string_view end = text.substr(text.size() - max);
  while (!end.empty() && (static_cast<unsigned char>(end.front()) & 0xc0U) == 0x80U) {
    end.remove_prefix(1);
  }
  return end;
}

std::string without_controls(std::string_view text, bool keeps_lines) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::optional<Character> next = first_character(text);
    const std::size_t length = next ? next->length : 1;
    const bool is_kept = next && (!is_control(next->point) || (keeps_lines && next->point == '\n'));
    if (is_kept) {
      result += text.substr(0, length);
    } else {
      result += escaped(next ? next->point : static_cast<unsigned char>(text.front()));
    }
    text.remove_prefix(length);
  }
  return result;
}

}  // namespace

bool is_utf8_text(std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const std::optional<Character> next = first_character(bytes);
    if (!next) return false;
    bytes.remove_prefix(next->length);
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

bool has_controls(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::optional<Character> next = first_character(text);
    if (!next || is_control(next->point)) return true;
    text.remove_prefix(next->length);
  }
  return false;
}

std::string printable_lines(std::string_view text) { return without_controls(text, true); }

std::string printable(std::string_view text, std::size_t max) {
  if (text.size() <= max) return without_controls(text, false);
  const std::size_t end = max / 4;
  return without_controls(text.substr(0, max - end), false) + " ... (" +
         std::to_string(text.size()) + " bytes) ... " + without_controls(end_of(text, end), false);
}

}  // namespace pcavr
