// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/report_command.hpp"

#include <string_view>
#include <utility>

namespace pcavr {
namespace {

std::string& stored_command() {
  static std::string command;
  return command;
}

/// Quoted for a POSIX shell, unless all its characters are plain.
std::string quoted(std::string_view word) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./:=,+@%";
  const bool is_plain = !word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos;
  if (is_plain) return std::string(word);
  std::string text = "'";
  for (const char character : word) {
    if (character == '\'') {
      text += "'\\''";
    } else {
      text += character;
    }
  }
  return text + '\'';
}

/// Options that say where a report goes or how it is made, and not what is in it: their values,
/// too.
bool is_left_out(std::string_view word) {
  const bool has_joined_value = word.starts_with("--output=") || word.starts_with("--report=") ||
                                word.starts_with("--threads=") ||
                                (word.starts_with("-o") && word.size() > 2);
  return word == "--force" || word == "--json" || has_joined_value;
}
bool is_left_out_with_value(std::string_view word) {
  return word == "-o" || word == "--output" || word == "--report" || word == "--threads";
}

}  // namespace

std::string command_of(std::span<char* const> words) {
  std::string command = "pcavr";
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (is_left_out_with_value(words[i])) {
      ++i;
    } else if (!is_left_out(words[i])) {
      command += ' ' + quoted(words[i]);
    }
  }
  return command;
}

void set_report_command(std::string command) { stored_command() = std::move(command); }

const std::string& report_command() { return stored_command(); }

}  // namespace pcavr
