// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// Whether there is a file or folder of this name. An Error where that can't be known (a folder on
/// the path that may not be read, a loop of symbolic links), or where the name is a symbolic link
/// to something that is missing. Thread-safe.
[[nodiscard]] Expected<bool> is_present(const std::filesystem::path& path);

/// The size in bytes of a regular file. An Error for anything else (a folder, a pipe, a device) and
/// for a file that can't be opened: nothing that could block or never end. Thread-safe.
[[nodiscard]] Expected<std::uintmax_t> regular_file_size(const std::filesystem::path& path);

}  // namespace pcavr
