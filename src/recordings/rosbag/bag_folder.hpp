// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// The content of a rosbag2 folder's metadata.yaml, as far as it is used: its times and counts may
/// be wrong.
struct BagFolder {
  std::vector<std::filesystem::path> files;  ///< in order
  bool is_message_compressed = false;        ///< each payload alone, with zstd
  std::vector<std::string> warnings;
};

/// Whether the name has one of these endings, or one of them and that of a packed file.
[[nodiscard]] bool is_bag_name(std::string_view name,
                               std::initializer_list<std::string_view> endings);

/// Whether the folder has metadata.yaml of rosbag2, or .mcap or .db3 files.
[[nodiscard]] bool is_bag_folder(const std::filesystem::path& folder);

/// The files that metadata.yaml lists; without it, or where none of these is there, all .mcap or
/// .db3 files of the folder by name, with numbers in it in their order. A packed file is left out
/// where it is there unpacked too.
[[nodiscard]] Expected<BagFolder> read_bag_folder(const std::filesystem::path& folder);

}  // namespace pcavr
