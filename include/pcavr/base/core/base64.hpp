// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr {

/// RFC 4648, with padding. Thread-safe.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace pcavr
