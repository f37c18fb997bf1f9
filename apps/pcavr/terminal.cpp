// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "terminal.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include <sys/ioctl.h>
#include <unistd.h>

namespace pcavr::app {
namespace {

constexpr std::size_t kDefaultWidth = 80;  ///< [characters]
constexpr std::size_t kMinWidth = 40;      ///< narrower, an option's text has too little room

/// A variable of the environment; empty where it is not set.
std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

const char* code_of(TextStyle style) {
  switch (style) {
    case TextStyle::kHeading:
      return "\033[1m";  // bold
    case TextStyle::kWarning:
      return "\033[33m";  // yellow
    case TextStyle::kError:
      return "\033[31m";  // red
  }
  return "";
}

}  // namespace

std::size_t help_width() {
  std::size_t width = 0;
  const std::string_view columns = environment("COLUMNS");
  std::from_chars(columns.data(), columns.data() + columns.size(), width);
  winsize size{};
  if (width == 0 && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  return width == 0 ? kDefaultWidth : std::max(width, kMinWidth);
}

bool has_colors(int descriptor) {
  return ::isatty(descriptor) != 0 && environment("NO_COLOR").empty() &&
         environment("TERM") != "dumb";
}

std::string styled(std::string_view text, TextStyle style, bool with_colors) {
  if (!with_colors) return std::string(text);
  return code_of(style) + std::string(text) + "\033[0m";
}

}  // namespace pcavr::app
