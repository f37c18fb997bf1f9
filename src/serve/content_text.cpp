// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "content_text.hpp"

#include <cctype>
#include <charconv>
#include <utility>

#include "gzip.hpp"

namespace pcavr {

Content make_content(std::string media_type, std::string body) {
  std::string compressed = gzip(body);
  const bool is_smaller = compressed.size() < body.size();
  return {.media_type = std::move(media_type),
          .body = is_smaller ? std::move(compressed) : std::move(body),
          .is_gzipped = is_smaller};
}

std::string percent_encoded(std::string_view name) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  constexpr std::string_view kPlain = "-._~";
  std::string text;
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool is_plain =
        byte < 0x80 && (std::isalnum(byte) != 0 || kPlain.find(letter) != kPlain.npos);
    if (is_plain) {
      text += letter;
    } else {
      text += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return text;
}

std::string percent_decoded(std::string_view text) {
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char byte = 0;
    const char* end = text.data() + i + 3;
    const bool is_code =
        text[i] == '%' && i + 2 < text.size() && std::from_chars(end - 2, end, byte, 16).ptr == end;
    name += is_code ? static_cast<char>(byte) : text[i];
    i += is_code ? 2 : 0;
  }
  return name;
}

}  // namespace pcavr
