// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pcavr::robot {

/// The file that package://NAME/PATH, file://PATH or a path refers to in the description `file`;
/// see UrdfOptions::package_folders. Nothing where there is no such regular file.
[[nodiscard]] std::optional<std::filesystem::path> resolve_mesh(
    const std::string& reference, const std::filesystem::path& file,
    const std::vector<std::filesystem::path>& package_folders);

}  // namespace pcavr::robot
