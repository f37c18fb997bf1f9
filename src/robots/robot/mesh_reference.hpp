// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pcavr::robot {

struct MeshReference {
  std::filesystem::path file;  ///< empty where there is no such regular file, or it is not read
  bool is_outside = false;     ///< there is a file, in no folder that may be read
};

/// The file that package://NAME/PATH, file://PATH or a path refers to in the description `file`;
/// see UrdfOptions::package_folders.
[[nodiscard]] MeshReference resolve_mesh(const std::string& reference,
                                         const std::filesystem::path& file,
                                         const std::vector<std::filesystem::path>& package_folders);

}  // namespace pcavr::robot
