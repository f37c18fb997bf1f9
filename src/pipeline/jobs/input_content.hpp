// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The regular files at `path`: itself, or those below a folder, to any depth, by name. Hidden ones
/// (unfinished outputs) are left out, and so is `without`, a folder directly in it. An Error where
/// there is nothing, or a folder can't be read.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> files_at(
    const std::filesystem::path& path, const std::string& without = {});

/// SHA-256 of names and bytes of files; names relative to `base`.
[[nodiscard]] Expected<std::string> content_of(const std::vector<std::filesystem::path>& files,
                                               const std::filesystem::path& base);

/// SHA-256 of names, sizes and times of the last change: where it is the same, the content is taken
/// to be the same without being read.
[[nodiscard]] Expected<std::string> listing_of(const std::vector<std::filesystem::path>& files,
                                               const std::filesystem::path& base);

/// Both of what was found at one time.
struct InputContent {
  std::string content = {};
  std::string listing = {};
};
[[nodiscard]] Expected<InputContent> input_content(const std::filesystem::path& path,
                                                   const std::string& without = {});

/// Whether what is at `path` now has the content of before. Files of another listing are read.
[[nodiscard]] Expected<bool> is_unchanged(const InputContent& before,
                                          const std::filesystem::path& path,
                                          const std::string& without = {});

}  // namespace pcavr
