// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace pcavr {

/// "near matches: a, b" for the hint of an error: those of `names` that contain `name` or one of
/// its parts, or the first few.
[[nodiscard]] std::string near_names_hint(const std::string& name,
                                          const std::vector<std::string>& names);

}  // namespace pcavr
