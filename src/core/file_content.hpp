// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace pcavr {

/// Writes the content to the file, replacing what it held; flushes it (fsync) with `to_disk`.
/// Returns 0, or the errno of what failed.
[[nodiscard]] int write_content(const std::filesystem::path& path, std::string_view content,
                                bool to_disk);

/// Flushes an open file or folder to the disk (fsync). Returns 0 or errno; 0 also on file systems
/// that can't, because losing the result would be worse.
[[nodiscard]] int sync_file(int file);

}  // namespace pcavr
