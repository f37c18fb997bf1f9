// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/option_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string_view>

#include "pcavr/base/core/options.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {
namespace {

/// The shortest decimal form that is read back to the same value.
std::string option_text(const OptionRow& row, double value) {
  if (row.kind == OptionKind::kBool) return value > 0.5 ? "true" : "false";
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string unit_text(const OptionRow& row) {
  return row.unit.empty() ? "" : ' ' + std::string(row.unit);
}

/// "a number from 0.001 to 0.1 m".
std::string permitted_values(const OptionRow& row) {
  if (row.kind == OptionKind::kBool) return "true or false";
  const std::string kind = row.kind == OptionKind::kInteger ? "an integer" : "a number";
  return kind + " from " + option_text(row, row.min) + " to " + option_text(row, row.max) +
         unit_text(row);
}

/// Levenshtein's distance: the minimum number of inserted, removed and replaced characters.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// Finds the map's key `name` by the projection; fails with the nearest known name where there is
/// none.
template <typename Range, typename Projection>
auto find_named(const YamlValue& map, const Range& range, const std::string& name, const char* what,
                Projection name_of) {
  const auto found = std::ranges::find(range, std::string_view(name), name_of);
  if (found != range.end()) return found;
  const auto distance = [&](const auto& item) {
    return edit_distance(name, std::invoke(name_of, item));
  };
  const auto nearest = std::ranges::min_element(range, {}, distance);
  const std::string message = "unknown " + std::string(what) + " '" + name + "'";
  if (nearest == range.end()) map.fail_at_key(name, message, "remove it");
  map.fail_at_key(name, message,
                  "the nearest known " + std::string(what) + " is '" +
                      std::string(std::invoke(name_of, *nearest)) + "'");
}

double option_value(const OptionRow& row, const YamlValue& value) {
  const std::string text = value.text();
  const std::string hint = "write " + permitted_values(row);
  if (row.kind == OptionKind::kBool) {
    if (text != "true" && text != "false") value.fail("is '" + text + "'", hint);
    return text == "true" ? 1.0 : 0.0;
  }
  const std::optional<double> number = parse_number(text);
  if (!number) value.fail("'" + text + "' is not a finite number", hint);
  if (row.kind == OptionKind::kInteger && *number != std::floor(*number)) {
    value.fail("'" + text + "' is not an integer", hint);
  }
  if (!(*number >= row.min && *number <= row.max)) value.fail(text + " is out of range", hint);
  return *number;
}

std::string_view section_name(const OptionSection& section) { return section.name; }

void apply_section(const OptionSection& section, const YamlValue& values) {
  for (const auto& [key, value] : values.entries()) {
    const auto row = find_named(values, section.rows, key, "key", &OptionRow::name);
    row->set(option_value(*row, value));
  }
  if (!section.check) return;
  if (const std::optional<Error> error = section.check()) values.fail(error->message, error->hint);
}

}  // namespace

Expected<void> parse_options(const std::string& text, const std::string& file,
                             std::span<const OptionSection> sections) {
  const std::optional<Error> error = read_yaml(text, file, [&](const YamlValue& root) {
    for (const auto& [name, values] : root.entries()) {
      apply_section(*find_named(root, sections, name, "section", section_name), values);
    }
  });
  if (error) return *error;
  return {};
}

Expected<void> read_options(const std::filesystem::path& file,
                            std::span<const OptionSection> sections) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_options(*text, file.string(), sections);
}

std::string print_options(std::span<const OptionSection> sections) {
  std::string text;
  for (const OptionSection& section : sections) {
    text += (text.empty() ? "" : "\n") + section.name + ":\n";
    for (const OptionRow& row : section.rows) {
      text += "  # " + std::string(row.meaning) + "; " + permitted_values(row) + ", default " +
              option_text(row, row.default_value) + "\n";
      text += "  # " + std::string(row.effects) + "\n";
      text += "  " + std::string(row.name) + ": " + option_text(row, row.get()) + "\n";
    }
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> changed_options(
    std::span<const OptionSection> sections) {
  std::vector<std::pair<std::string, std::string>> changed;
  for (const OptionSection& section : sections) {
    for (const OptionRow& row : section.rows) {
      const double value = row.get();
      if (value == row.default_value) continue;
      changed.emplace_back(section.name + '.' + std::string(row.name), option_text(row, value));
    }
  }
  return changed;
}

}  // namespace pcavr
