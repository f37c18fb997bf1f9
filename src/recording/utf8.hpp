// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr {

/// Whether the bytes are UTF-8 (Unicode 15, table 3-7) and stand for characters: no lone surrogate,
/// nothing overlong, none of the code points that are never to be one (U+FFFE, U+FDD0...). Only
/// such a text can be written to YAML and JSON and comes back the same.
[[nodiscard]] bool is_utf8_text(std::string_view bytes) noexcept;

/// The same where it is UTF-8, else with U+FFFD for each byte above ASCII: a path may hold any
/// bytes, and a manifest that names it has to be read again.
[[nodiscard]] std::string as_utf8_text(std::string_view bytes);

}  // namespace pcavr
