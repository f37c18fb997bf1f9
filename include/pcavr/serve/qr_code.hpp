// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// A text as a QR code [ISO/IEC 18004] of characters, two modules above each other in one, black on
/// white whatever the terminal's colours are. Empty where the text is too long for one.
[[nodiscard]] std::string qr_code_for_terminal(const std::string& text);

/// The same as an SVG picture.
[[nodiscard]] std::string qr_code_svg(const std::string& text);

}  // namespace pcavr
