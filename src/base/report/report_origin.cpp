// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/report_origin.hpp"

#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <string_view>
#include <utility>

namespace pcavr {
namespace {

ReportOrigin& stored_origin() {
  static ReportOrigin origin;
  return origin;
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

/// [s] since 1970.
std::time_t time_of_report() {
  const char* const given = std::getenv("SOURCE_DATE_EPOCH");
  const std::string_view text = given == nullptr ? std::string_view() : std::string_view(given);
  std::time_t seconds = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), seconds);
  const bool is_number =
      !text.empty() && read.ec == std::errc() && read.ptr == text.data() + text.size();
  if (is_number) return seconds;
  return std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
}

std::string date_text(std::time_t seconds) {
  std::tm parts{};
  if (gmtime_r(&seconds, &parts) == nullptr) return {};
  std::array<char, 64> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &parts);
  return {text.data(), length};
}

}  // namespace

ReportOrigin origin_of_command(std::span<char* const> words) {
  ReportOrigin origin{.command = "pcavr", .date = date_text(time_of_report())};
  for (std::size_t i = 1; i < words.size(); ++i) origin.command += ' ' + quoted(words[i]);
  return origin;
}

void set_report_origin(ReportOrigin origin) { stored_origin() = std::move(origin); }

const ReportOrigin& report_origin() { return stored_origin(); }

}  // namespace pcavr
