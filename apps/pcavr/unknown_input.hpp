// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/base/core/expected.hpp"

namespace pcavr::app {

/// The error for a path that is none of what `inspect` reads; names the first bag in a folder of
/// bags.
[[nodiscard]] Error unknown_input(const std::filesystem::path& path);

}  // namespace pcavr::app
