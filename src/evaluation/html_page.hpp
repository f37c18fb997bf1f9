// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// A whole HTML document with the reports' one style sheet inside, so that it opens without a
/// network. `title` is text, `body` is markup.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& body);

}  // namespace pcavr
