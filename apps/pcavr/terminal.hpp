// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr::app {

/// Width of help texts [characters]: COLUMNS if it is set, else that of the terminal on standard
/// output, else 80; at least 40.
[[nodiscard]] std::size_t help_width();

/// Whether a terminal on this descriptor is to show colours: not where the output is a file or a
/// pipe, NO_COLOR is set (no-color.org), or TERM is "dumb".
[[nodiscard]] bool has_colors(int descriptor);

enum class TextStyle { kHeading, kWarning, kError };

/// The text in this style, if `with_colors`; else unchanged.
[[nodiscard]] std::string styled(std::string_view text, TextStyle style, bool with_colors);

}  // namespace pcavr::app
