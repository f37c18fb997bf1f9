// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace pcavr {

/// Whether another file system, or a part of one, is mounted at this file or folder, so that it
/// can't be renamed or replaced.
[[nodiscard]] bool is_mount_point(const std::filesystem::path& path);

}  // namespace pcavr
