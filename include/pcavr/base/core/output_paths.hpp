// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The absolute path with symbolic links resolved (as realpath, but the last components need not
/// exist yet). Fails on an empty path, a loop of links, and a folder that can't be searched.
[[nodiscard]] Expected<std::filesystem::path> resolve_path(const std::filesystem::path& path);

/// Fails where an output is, contains or lies in an input or another output. Existing files and
/// folders are compared by device and inode, so links and bind mounts do not hide them. Empty
/// paths are ignored among the inputs, and are errors among the outputs.
[[nodiscard]] Expected<void> check_outputs(const std::vector<std::filesystem::path>& outputs,
                                           const std::vector<std::filesystem::path>& inputs);

}  // namespace pcavr
