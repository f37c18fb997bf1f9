// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "pcavr/base/core/input_ranges.hpp"

namespace pcavr::app {

/// Parses all of `text` as a number, independent of the locale; nothing where it is not a number.
/// "nan" and "inf" are numbers here: the range check rejects them.
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(const std::string& text) {
  Number number{};
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Accepts only a finite number in the range.
inline CLI::Validator number_in(const InputRange& range) {
  return CLI::Validator(
      [range](const std::string& text) {
        const std::optional<double> number = parse_number<double>(text);
        if (!number) return "'" + text + "' is not a number";
        const std::optional<Error> error = check_range(range, *number, text);
        return error ? error->to_string() : std::string();
      },
      "");
}

/// An option that accepts only a finite number in the range.
template <typename Value>
CLI::Option* add_number(CLI::App& command, const std::string& name, Value& value,
                        const InputRange& range, const std::string& what) {
  return command.add_option(name, value, what)->check(number_in(range));
}

/// An option that accepts only an integer from `min` to `max`.
template <typename Whole>
CLI::Option* add_whole(CLI::App& command, const std::string& name, Whole& value, Whole min,
                       Whole max, const std::string& what) {
  return command.add_option(name, value, what)
      ->check(CLI::Validator(
          [min, max](const std::string& text) {
            const std::optional<Whole> number = parse_number<Whole>(text);
            if (number && *number >= min && *number <= max) return std::string();
            return "'" + text + "' is not an integer from " + std::to_string(min) + " to " +
                   std::to_string(max);
          },
          ""));
}

/// The seed of a random generator: any value of its type.
inline CLI::Option* add_seed(CLI::App& command, std::uint64_t& seed, const std::string& what) {
  return add_whole<std::uint64_t>(command, "--seed", seed, 0,
                                  std::numeric_limits<std::uint64_t>::max(), what);
}

}  // namespace pcavr::app
