// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
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

template <typename... Values>
[[noreturn]] void fail_contract(const char* expression, const char* function,
                                const Values&... values) {
  std::ostringstream text;
  text << function << ": requires " << expression;
  ((text << ' ' << values), ...);
  throw ContractError(text.str());
}

}  // namespace detail
}  // namespace pcavr

/// Always on. Throws ContractError with the expression and the values given after it.
#define PCAVR_REQUIRE(condition, ...)                                                  \
  do {                                                                                 \
    if (!(condition)) {                                                                \
      ::pcavr::detail::fail_contract(#condition, __func__ __VA_OPT__(, ) __VA_ARGS__); \
    }                                                                                  \
  } while (false)
