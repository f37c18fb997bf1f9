// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/expected.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "pcavr/base/core/utf8.hpp"

namespace pcavr {
namespace {

/// Largest lengths [bytes] of a path (PATH_MAX), and of any other part: one that quotes a value of
/// megabytes names it no better.
constexpr std::size_t kMaxFile = 4096;
constexpr std::size_t kMaxPart = 1024;

}  // namespace

std::string Error::to_string() const {
  const auto line_of = [](std::string_view part, std::size_t max) {
    std::string text(part);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return printable(text, max);
  };
  std::string text = line_of(file, kMaxFile);
  if (line > 0) text += ':' + std::to_string(line);
  if (!place.empty()) text += (text.empty() ? "" : ": ") + line_of(place, kMaxPart);
  text += (text.empty() ? "" : ": ") + line_of(message, kMaxPart);
  if (!hint.empty()) text += "; " + line_of(hint, kMaxPart);
  return text;
}

}  // namespace pcavr
