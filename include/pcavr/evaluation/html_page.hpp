// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// A complete HTML document with the reports' style sheet inline, so that it opens offline. `title`
/// is text, `body` is markup.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& body);

}  // namespace pcavr
