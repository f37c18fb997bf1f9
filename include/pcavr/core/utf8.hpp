// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr {

/// Whether the bytes are valid UTF-8 (Unicode 15, table 3-7): no lone surrogate, no overlong
/// encoding, no noncharacter (U+FFFE, U+FDD0...). Only such a text survives a round trip through
/// YAML and JSON.
[[nodiscard]] bool is_utf8_text(std::string_view bytes) noexcept;

/// The text unchanged where it is UTF-8, else with U+FFFD for each byte above ASCII: a path may
/// contain any bytes, and a manifest that names it must remain readable.
[[nodiscard]] std::string as_utf8_text(std::string_view bytes);

}  // namespace pcavr
