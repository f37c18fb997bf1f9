// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/open_file.hpp"

namespace pcavr {

/// Reads a rosbag2 database, opened read-only and as immutable: SQLite then writes no files beside
/// it. `name` is the file's in errors.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_sqlite_bag(
    const std::filesystem::path& file, const std::string& name);
/// The same of an open file that has no name; it may be closed afterwards.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_sqlite_bag(const OpenFile& file,
                                                                   const std::string& name);

}  // namespace pcavr
