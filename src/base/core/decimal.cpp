// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/decimal.hpp"

#include <charconv>

namespace pcavr {

std::string shortest_decimal(double number) {
  char buffer[32];  // the longest shortest decimal has 24 characters
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr};
}

}  // namespace pcavr
