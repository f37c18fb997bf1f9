// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// Where a path leads: absolute, with symbolic links followed, also where its last parts are not
/// there yet. Fails on an empty path, a loop of links, and a folder that can't be searched.
[[nodiscard]] Expected<std::filesystem::path> resolve_path(const std::filesystem::path& path);

/// Fails where an output is, contains or lies in an input or another output. Files and folders are
/// compared by device and inode where they exist, so links and bind mounts do not hide them. Empty
/// paths are left out of the inputs, and are errors among the outputs.
[[nodiscard]] Expected<void> check_outputs(const std::vector<std::filesystem::path>& outputs,
                                           const std::vector<std::filesystem::path>& inputs);

}  // namespace pcavr
