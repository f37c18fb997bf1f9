// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pcavr::model {

/// [byte] No exporter writes a longer PLY header.
inline constexpr std::size_t kMaxHeader = 64 * 1024;

struct FileStart {
  std::string text;         ///< at most kMaxHeader bytes
  std::uintmax_t size = 0;  ///< [byte] of the whole file
};

/// Empty for a file that can't be read. Does not throw.
[[nodiscard]] FileStart read_file_start(const std::filesystem::path& file);

}  // namespace pcavr::model
