// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace pcavr {

/// Creates the file, which must not exist, or a symbolic link that someone else has put there would
/// decide what is overwritten. Returns 0, or the errno of what failed.
[[nodiscard]] int create_content(const std::filesystem::path& path, std::string_view content);
/// Replaces what an existing file holds, and flushes it (fsync). The same for a symbolic link.
[[nodiscard]] int replace_content(const std::filesystem::path& path, std::string_view content);
/// Adds to an existing file, without a flush.
[[nodiscard]] int append_content(const std::filesystem::path& path, std::string_view content);

/// Flushes an open file or folder to the disk (fsync). Returns 0 or errno; 0 also on file systems
/// that can't, because losing the result would be worse.
[[nodiscard]] int sync_file(int file);

}  // namespace pcavr
