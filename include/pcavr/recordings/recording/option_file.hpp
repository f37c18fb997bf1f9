// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/options.hpp"

namespace pcavr {

/// Sets the options of a YAML text: a map of sections, each a map of keys, all of them optional.
/// An unknown section or key is an Error that names the nearest known one; a value that is not a
/// finite number in the option's range is an Error with the range and its unit. After an Error the
/// options before the faulty line are set. Not thread-safe.
[[nodiscard]] Expected<void> parse_options(const std::string& text, const std::string& file,
                                           std::span<const OptionSection> sections);

/// Does the same as parse_options, with the text of a file.
[[nodiscard]] Expected<void> read_options(const std::filesystem::path& file,
                                          std::span<const OptionSection> sections);

/// The current values as YAML, with meaning, unit, range, default and effects as comments.
/// parse_options reads back identical values.
[[nodiscard]] std::string print_options(std::span<const OptionSection> sections);

/// The options that differ from their defaults: "section.key" and the value, in the sections'
/// order.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> changed_options(
    std::span<const OptionSection> sections);

}  // namespace pcavr
