// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>

namespace pcavr {

/// A bug of the caller: a documented precondition is violated.
/// Bad data from outside is never reported this way; see Expected.
class ContractError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace detail {

/// A value as printed in a ContractError; numbers with six digits.
[[nodiscard]] std::string value_text(int value);
[[nodiscard]] std::string value_text(unsigned value);
[[nodiscard]] std::string value_text(long value);
[[nodiscard]] std::string value_text(unsigned long value);
[[nodiscard]] std::string value_text(double value);
[[nodiscard]] std::string value_text(const std::string& value);

[[noreturn]] void throw_contract_error(const char* expression, const char* function,
                                       std::initializer_list<std::string> values);

template <typename... Values>
[[noreturn]] void fail_contract(const char* expression, const char* function,
                                const Values&... values) {
  throw_contract_error(expression, function, {value_text(values)...});
}

}  // namespace detail
}  // namespace pcavr

/// Always on. Throws ContractError with the expression and the values given after it: numbers and
/// texts.
#define PCAVR_REQUIRE(condition, ...)                                                  \
  do {                                                                                 \
    if (!(condition)) {                                                                \
      ::pcavr::detail::fail_contract(#condition, __func__ __VA_OPT__(, ) __VA_ARGS__); \
    }                                                                                  \
  } while (false)
