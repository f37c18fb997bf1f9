// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

/// All files under a folder, hidden ones too: relative path to content. A link is "-> target".
using FileTree = std::map<std::string, std::string>;

inline FileTree tree(const std::filesystem::path& folder) {
  FileTree files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name =
        std::filesystem::relative(entry.path().parent_path(), folder) / entry.path().filename();
    const std::string key = name.substr(0, 2) == "./" ? name.substr(2) : name;
    if (entry.is_symlink()) {
      files[key] = "-> " + std::filesystem::read_symlink(entry.path()).string();
    } else if (entry.is_regular_file()) {
      std::ifstream stream(entry.path(), std::ios::binary);
      files[key].assign(std::istreambuf_iterator<char>(stream), {});
    }
  }
  return files;
}

inline void write_tree(const std::filesystem::path& folder, const FileTree& files) {
  for (const auto& [name, content] : files) {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << content;
  }
}
