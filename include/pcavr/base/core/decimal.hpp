// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// The shortest decimal that reads back to the same number, whatever the locale.
[[nodiscard]] std::string shortest_decimal(double number);

}  // namespace pcavr
