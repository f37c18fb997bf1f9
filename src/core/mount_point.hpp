// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace pcavr {

/// Whether another file system, or a part of one, is mounted at this file or folder: it can't be
/// renamed then, nor another put in its place.
[[nodiscard]] bool is_mount_point(const std::filesystem::path& path);

}  // namespace pcavr
