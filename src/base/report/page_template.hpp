// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace pcavr {

/// The text in the template that a report's data replace.
inline constexpr std::string_view kDataPlace = "REPORT_DATA";

/// The report's page as built by npm, without data; empty where it was not built.
[[nodiscard]] std::string_view page_template();

}  // namespace pcavr
