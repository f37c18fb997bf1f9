// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// A date with a time of day, as programs write it.
struct DateTime {
  Stamp stamp;            ///< since 1970 in UTC; in local time where no zone is stated
  bool has_zone = false;  ///< "Z" or "+01:00" was stated
};

/// Reads a year, month and day, separated by '-', '/' or '.', then 'T' or spaces, hours and minutes
/// and seconds, separated by ':' or '.', with up to nine decimals, then perhaps AM or PM, and a
/// zone: "2025-03-12T10:20:34.567Z", "2025-03-12 10.20.34.567 AM", "2025/03/12 10:20:34+01:00".
/// nullopt for anything else, and for a date that does not exist. Years 1970 to 2099.
[[nodiscard]] std::optional<DateTime> parse_date_time(std::string_view text);

}  // namespace pcavr
