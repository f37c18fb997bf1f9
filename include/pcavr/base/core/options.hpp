// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// One user option: the only place of its default, range, unit and meaning. Bools are 0 or 1.
/// A module lists the fields of an options struct in a constexpr std::array in a .cpp file:
///
///     constexpr auto kSlidingFields = std::to_array<OptionField<SlidingOptions>>({
///         {"min_speed", &SlidingOptions::min_speed, 0.002, 1e-4, 0.1, "m/s",
///          "speed below which a sample counts as static",
///          "lower: noise counts as sliding; higher: slow pushes are ignored"},
///     });
///     static_assert(are_valid_fields(kSlidingFields));
///     SlidingOptions::SlidingOptions() { set_defaults(*this, kSlidingFields); }
///     OptionSection section_of(SlidingOptions& options) {
///       return make_section("identification.sliding", options, kSlidingFields);
///     }
template <typename Options>
struct OptionField {
  std::string_view name;
  std::variant<double Options::*, int Options::*, bool Options::*> member;
  double default_value;
  double min;
  double max;
  std::string_view unit;     ///< empty for a number without unit, a count and a bool
  std::string_view meaning;  ///< one line, without full stop
  std::string_view effects;  ///< what goes wrong at each end: "lower: ...; higher: ..."
};

enum class OptionKind { kNumber, kInteger, kBool };

/// A field of one options object, independent of the object's type.
struct OptionRow {
  std::string_view name;
  OptionKind kind = OptionKind::kNumber;
  double default_value = 0.0;
  double min = 0.0;
  double max = 0.0;
  std::string_view unit;
  std::string_view meaning;
  std::string_view effects;
  std::function<double()> get;
  std::function<void(double)> set;  ///< the caller checks range and kind first
};

/// The options of one object under their name in a configuration file. Refers to the object, which
/// must outlive the section.
struct OptionSection {
  std::string name;  ///< dotted path, "tracking.objects"
  std::vector<OptionRow> rows;
  /// Set where fields constrain each other: what is wrong with the values, without file and line.
  std::function<std::optional<Error>()> check = {};
};

/// Whether names are present and distinct, ranges finite and defaults inside; for static_assert.
template <typename Options, std::size_t N>
[[nodiscard]] constexpr bool are_valid_fields(const std::array<OptionField<Options>, N>& fields) {
  constexpr double kMax = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < N; ++i) {
    const OptionField<Options>& field = fields[i];
    const bool is_bool = std::holds_alternative<bool Options::*>(field.member);
    if (field.name.empty() || field.meaning.empty() || field.effects.empty()) return false;
    if (!(field.min >= -kMax && field.min < field.max && field.max <= kMax)) return false;
    if (!(field.default_value >= field.min && field.default_value <= field.max)) return false;
    if (is_bool && (field.min != 0.0 || field.max != 1.0)) return false;
    for (std::size_t j = 0; j < i; ++j) {
      if (fields[j].name == field.name || fields[j].member == field.member) return false;
    }
  }
  return true;
}

/// Sets the field from its number; integers and bools are rounded to the nearest.
template <typename Options>
void set_field(Options& options, const OptionField<Options>& field, double value) {
  if (const auto* real = std::get_if<double Options::*>(&field.member)) {
    options.*(*real) = value;
  } else if (const auto* integer = std::get_if<int Options::*>(&field.member)) {
    options.*(*integer) = static_cast<int>(std::lround(value));
  } else {
    options.*std::get<bool Options::*>(field.member) = value > 0.5;
  }
}

template <typename Options>
[[nodiscard]] double get_field(const Options& options, const OptionField<Options>& field) {
  return std::visit([&](auto member) { return static_cast<double>(options.*member); },
                    field.member);
}

template <typename Options, std::size_t N>
void set_defaults(Options& options, const std::array<OptionField<Options>, N>& fields) {
  for (const OptionField<Options>& field : fields) set_field(options, field, field.default_value);
}

/// `fields` must outlive the section, as a constexpr table does.
template <typename Options, std::size_t N>
[[nodiscard]] OptionSection make_section(std::string_view name, Options& options,
                                         const std::array<OptionField<Options>, N>& fields) {
  OptionSection section{.name = std::string(name), .rows = {}, .check = {}};
  for (const OptionField<Options>& field : fields) {
    section.rows.push_back(
        {.name = field.name,
         .kind = static_cast<OptionKind>(field.member.index()),
         .default_value = field.default_value,
         .min = field.min,
         .max = field.max,
         .unit = field.unit,
         .meaning = field.meaning,
         .effects = field.effects,
         .get = [&options, &field] { return get_field(options, field); },
         .set = [&options, &field](double value) { set_field(options, field, value); }});
  }
  return section;
}

}  // namespace pcavr
