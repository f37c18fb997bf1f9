// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pcavr {

/// Largest length of a printed line: a longer one hides the others. A path may have 4096 bytes.
inline constexpr std::size_t kMaxPrintedBytes = 8192;

/// Whether the bytes are valid UTF-8 (Unicode 15, table 3-7): no lone surrogate, no overlong
/// encoding, no noncharacter (U+FFFE, U+FDD0...). Only such a text survives a round trip through
/// YAML and JSON.
[[nodiscard]] bool is_utf8_text(std::string_view bytes) noexcept;

/// The text unchanged where it is UTF-8, else with U+FFFD for each byte above ASCII: a path may
/// contain any bytes, and a manifest that names it must remain readable.
[[nodiscard]] std::string as_utf8_text(std::string_view bytes);

/// Text from a file, a peer or a user as it may be printed: control characters of terminals and of
/// the direction of writing, and bytes that are not UTF-8, as "\x1b" or "\u202e"; of one longer
/// than `max` bytes the beginning, its length and the end.
[[nodiscard]] std::string printable(std::string_view text, std::size_t max = kMaxPrintedBytes);
/// The same of text of several lines and of any length.
[[nodiscard]] std::string printable_lines(std::string_view text);
/// Whether printable() would change a short text.
[[nodiscard]] bool has_controls(std::string_view text) noexcept;

}  // namespace pcavr
