// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace pcavr {

/// Writes the whole content over what is there; with `to_disk` it is on the disk afterwards. Gives
/// 0, or the errno of what failed.
[[nodiscard]] int write_content(const std::filesystem::path& path, std::string_view content,
                                bool to_disk);

/// Brings an open file or folder to the disk. Gives 0 or errno; 0 also on file systems that can't,
/// which is no reason to lose the work.
[[nodiscard]] int sync_file(int file);

}  // namespace pcavr
