// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/date_time.hpp"

#include <cctype>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {
namespace {

/// Takes parts off the front of a text.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }

  /// A whole number of `least` to `most` digits.
  std::optional<int> number(std::size_t least, std::size_t most) {
    std::size_t size = 0;
    int value = 0;
    while (size < most && size < rest_.size() && is_digit(rest_[size])) {
      value = 10 * value + (rest_[size++] - '0');
    }
    if (size < least) return std::nullopt;
    rest_.remove_prefix(size);
    return value;
  }
  /// One of these characters.
  bool take(std::string_view characters) {
    if (rest_.empty() || characters.find(rest_.front()) == characters.npos) return false;
    rest_.remove_prefix(1);
    return true;
  }
  /// The decimals of a second, in nanoseconds; those beyond nine are cut.
  std::int64_t decimals() {
    std::int64_t nanoseconds = 0, unit = 100'000'000;
    for (; !rest_.empty() && is_digit(rest_.front()); rest_.remove_prefix(1), unit /= 10) {
      nanoseconds += unit * (rest_.front() - '0');
    }
    return nanoseconds;
  }
  void skip_blanks() {
    while (take(" \t")) {
    }
  }

 private:
  static bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

  std::string_view rest_;
};

std::optional<std::chrono::sys_days> date_of(Scanner& text) {
  const auto year = text.number(4, 4);
  if (!year || *year < 1970 || *year > 2099 || !text.take("-/.")) return std::nullopt;
  const auto month = text.number(1, 2);
  if (!month || !text.take("-/.")) return std::nullopt;
  const auto day = text.number(1, 2);
  if (!day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date);
}

/// [ns] of the day.
std::optional<Duration> time_of_day(Scanner& text) {
  const auto hours = text.number(1, 2);
  if (!hours || !text.take(":.")) return std::nullopt;
  const auto minutes = text.number(2, 2);
  if (!minutes || !text.take(":.")) return std::nullopt;
  const auto seconds = text.number(2, 2);
  if (!seconds || *hours > 23 || *minutes > 59 || *seconds > 60) return std::nullopt;
  const std::int64_t decimals = text.take(".,") ? text.decimals() : 0;
  text.skip_blanks();
  int hour = *hours;
  const bool is_afternoon = text.take("pP");
  if (is_afternoon || text.take("aA")) {
    if (!text.take("mM") || hour < 1 || hour > 12) return std::nullopt;
    hour = hour % 12 + (is_afternoon ? 12 : 0);
    text.skip_blanks();
  }
  return std::chrono::hours(hour) + std::chrono::minutes(*minutes) +
         std::chrono::seconds(*seconds) + std::chrono::nanoseconds(decimals);
}

}  // namespace

std::optional<DateTime> parse_date_time(std::string_view text) {
  Scanner scanner(trimmed(text));
  const auto date = date_of(scanner);
  if (!date || !scanner.take("T ")) return std::nullopt;
  scanner.skip_blanks();
  const auto time = time_of_day(scanner);
  if (!time) return std::nullopt;
  DateTime found{.stamp = Stamp{} + (Duration(date->time_since_epoch()) + *time)};
  if (scanner.is_at_end()) return found;
  found.has_zone = true;
  if (scanner.take("Z")) return scanner.is_at_end() ? std::optional(found) : std::nullopt;
  const bool is_west = scanner.take("-");
  if (!is_west && !scanner.take("+")) return std::nullopt;
  const auto hours = scanner.number(2, 2);
  (void)scanner.take(":");
  const auto minutes = scanner.is_at_end() ? std::optional(0) : scanner.number(2, 2);
  if (!hours || !minutes || *hours > 14 || *minutes > 59 || !scanner.is_at_end()) {
    return std::nullopt;
  }
  const Duration offset = std::chrono::hours(*hours) + std::chrono::minutes(*minutes);
  found.stamp = found.stamp + (is_west ? offset : -offset);
  return found;
}

}  // namespace pcavr
