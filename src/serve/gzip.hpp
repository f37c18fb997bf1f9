// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pcavr {

/// RFC 1952. Thread-safe.
[[nodiscard]] std::string gzip(std::string_view plain);
/// Nothing where it is no gzip file of one member, or would be larger than `most` bytes.
[[nodiscard]] std::optional<std::string> gunzip(std::string_view packed, std::size_t most);

}  // namespace pcavr
