// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Whether a file or folder of this name exists. An Error where that can't be determined (no
/// permission on the path, a loop of symbolic links), or where the name is a dangling symbolic
/// link. Thread-safe.
[[nodiscard]] Expected<bool> is_present(const std::filesystem::path& path);

/// The problem with a file that a list names, such as "is missing" or "is a named pipe, not a
/// regular file"; empty where it is a regular file that can be opened. Thread-safe.
[[nodiscard]] std::string fault_of_listed(const std::filesystem::path& path);

/// The size in bytes of a regular file. An Error for a file that can't be opened and for anything
/// else (a folder, a pipe, a device): reading those could block or never end. Thread-safe.
[[nodiscard]] Expected<std::uintmax_t> regular_file_size(const std::filesystem::path& path);

}  // namespace pcavr
