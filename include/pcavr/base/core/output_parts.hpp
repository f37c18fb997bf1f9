// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// As write_file() (output.hpp), of content that comes in parts, until one is empty: it need not be
/// in memory at once.
[[nodiscard]] Expected<void> write_file_in_parts(const std::filesystem::path& target,
                                                 const std::function<std::string()>& next_part);

}  // namespace pcavr
