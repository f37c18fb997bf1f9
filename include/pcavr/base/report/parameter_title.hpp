// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace pcavr {

/// A parameter as a report names it: "Limiting friction F_M" for the parameter file's
/// "limiting_static_friction". Of an unknown key, its words.
[[nodiscard]] std::string parameter_title(std::string_view key);

}  // namespace pcavr
