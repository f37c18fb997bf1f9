// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Integrity check for text files: the number of lines when they were written, including header
/// and comments, by path relative to the manifest's folder. A file that ends inside a line, or that
/// has another number of lines, was truncated or changed since: by a full disk, an interrupted
/// copy, an editor.
using LineCounts = std::map<std::string, std::size_t>;

/// Written next to `recording.yaml`, whose keys are fixed by the format, for recordings that pcavr
/// wrote. Other manifests contain the counts themselves, under the same key `lines`.
inline constexpr char kWrittenFile[] = "written.yaml";

/// Counts the lines of every .txt and .csv below `folder`, except in `truth/`.
[[nodiscard]] Expected<LineCounts> count_lines(const std::filesystem::path& folder);

/// Counts the lines and writes the counts to kWrittenFile in the folder.
[[nodiscard]] Expected<void> write_line_counts(const std::filesystem::path& folder);

/// The key `lines` of a manifest. nullopt where the manifest is absent or has no such key, because
/// an older version or another program wrote it.
[[nodiscard]] Expected<std::optional<LineCounts>> read_line_counts(
    const std::filesystem::path& manifest);

/// An Error unless the file still has the `lines` lines that were written.
[[nodiscard]] Expected<void> check_line_count(const std::filesystem::path& file, std::size_t lines);
/// The same for a text that has already been read.
[[nodiscard]] Expected<void> check_line_count(std::string_view text, std::size_t lines,
                                              const std::filesystem::path& file);

/// Checks every file that the manifest has a count for; missing files are ignored. Does nothing
/// where there are no counts.
[[nodiscard]] Expected<void> check_line_counts(const std::filesystem::path& manifest);

}  // namespace pcavr
