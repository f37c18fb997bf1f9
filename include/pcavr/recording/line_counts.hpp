// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// How many lines the text files had when they were written, header and comments included, by path
/// relative to the manifest's folder. A file that ends inside a line, or that has another number of
/// lines, was cut or changed since: by a full disk, a broken copy, an editor.
using LineCounts = std::map<std::string, std::size_t>;

/// Kept beside `recording.yaml`, whose keys are those of the format, wherever pcavr itself wrote
/// the recording. Other manifests hold the counts themselves, under the same key `lines`.
inline constexpr char kWrittenFile[] = "written.yaml";

/// Counts every .txt and .csv below `folder`, but for `truth/`.
[[nodiscard]] Expected<LineCounts> count_lines(const std::filesystem::path& folder);

/// Counts, and writes them as kWrittenFile into the folder.
[[nodiscard]] Expected<void> write_line_counts(const std::filesystem::path& folder);

/// The key `lines` of a manifest. Nothing where the manifest is absent, or has no such key: an
/// older version, or another program, wrote it.
[[nodiscard]] Expected<std::optional<LineCounts>> read_line_counts(
    const std::filesystem::path& manifest);

/// What is wrong with one file that was written with `lines` lines, if anything.
[[nodiscard]] Expected<void> check_line_count(const std::filesystem::path& file, std::size_t lines);
/// The same for a text that was read already.
[[nodiscard]] Expected<void> check_line_count(std::string_view text, std::size_t lines,
                                              const std::filesystem::path& file);

/// Holds every file that the manifest counts against it; those that are missing are passed over.
/// Does nothing where there are no counts.
[[nodiscard]] Expected<void> check_line_counts(const std::filesystem::path& manifest);

}  // namespace pcavr
