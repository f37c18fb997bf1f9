// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pcavr {

/// RFC 1952. Thread-safe.
[[nodiscard]] std::string gzip(std::string_view plain);
/// Empty if it is not a gzip file with one member, or is larger than `max_bytes` uncompressed.
[[nodiscard]] std::optional<std::string> gunzip(std::string_view compressed, std::size_t max_bytes);

}  // namespace pcavr
