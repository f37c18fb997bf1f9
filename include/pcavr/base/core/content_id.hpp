// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pcavr {

/// Recognises equal contents, not forged ones: FNV-1a of 64 bits [Fowler, Noll and Vo], of these
/// bytes after those that `before` is of.
[[nodiscard]] std::uint64_t fnv1a(std::span<const std::byte> bytes,
                                  std::uint64_t before = 14695981039346656037ULL);

/// Such a number as 16 hexadecimal digits, and whether a text is one.
[[nodiscard]] std::string content_id(std::uint64_t hash);
[[nodiscard]] bool is_content_id(std::string_view text);

}  // namespace pcavr
