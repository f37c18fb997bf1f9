// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/bag_folder.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kPackings[] = {".bz2", ".zst", ".zstd"};

bool is_packed(const fs::path& file) {
  return std::find(std::begin(kPackings), std::end(kPackings), file.extension().string()) !=
         std::end(kPackings);
}

/// Digits count as one number: bag_2 is before bag_10.
bool is_before(const fs::path& first, const fs::path& second) {
  const auto parts = [](const std::string& name) {
    std::vector<std::pair<std::string, std::string>> split;  // text, then number without zeros
    for (std::size_t i = 0; i < name.size();) {
      auto& [text, number] = split.emplace_back();
      while (i < name.size() && std::isdigit(static_cast<unsigned char>(name[i])) == 0)
        text += name[i++];
      while (i < name.size() && std::isdigit(static_cast<unsigned char>(name[i])) != 0)
        number += name[i++];
      number.erase(0, std::min(number.find_first_not_of('0'), number.size()));
    }
    return split;
  };
  const auto a = parts(first.filename().string());
  const auto b = parts(second.filename().string());
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](const auto& x, const auto& y) {
                                        return std::tuple(x.first, x.second.size(), x.second) <
                                               std::tuple(y.first, y.second.size(), y.second);
                                      });
}

std::vector<fs::path> bag_files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const fs::path& file = entry.path();
    const bool is_twice = fs::exists(folder / file.stem(), code) && is_packed(file);
    if (is_bag_name(file.filename().string(), {".mcap", ".db3"}) && !is_twice &&
        entry.is_regular_file(code)) {
      files.push_back(file);
    }
  }
  std::sort(files.begin(), files.end(), is_before);
  return files;
}

/// The file, or, where someone packed it later, that; empty where neither is there.
fs::path plain_or_packed(const fs::path& file) {
  std::error_code code;
  if (fs::exists(file, code)) return file;
  for (const std::string_view packing : kPackings) {
    const fs::path packed = file.string() + std::string(packing);
    if (fs::exists(packed, code)) return packed;
  }
  return {};
}

/// Fills in what metadata.yaml states; a file that can't be understood counts as absent.
void read_metadata(const fs::path& folder, BagFolder& bag) {
  const fs::path file = folder / "metadata.yaml";
  std::error_code code;
  if (!fs::exists(file, code)) return;
  const Expected<std::string> text = read_file(file);
  try {
    const YAML::Node root = YAML::Load(text ? *text : std::string());
    const YAML::Node information = root["rosbag2_bagfile_information"];
    const auto mode = information["compression_mode"].as<std::string>("");
    bag.is_message_compressed = mode == "MESSAGE" || mode == "message";
    for (const YAML::Node& item : information["relative_file_paths"]) {
      // Older versions wrote paths relative to the folder's parent.
      const auto name = fs::path(item.as<std::string>("")).filename();
      if (name.empty()) continue;
      if (const fs::path there = plain_or_packed(folder / name); !there.empty())
        bag.files.push_back(there);
      else
        bag.warnings.push_back((folder / name).string() +
                               ": is listed by metadata.yaml, but is missing");
    }
  } catch (const YAML::Exception&) {
    bag.warnings.push_back(file.string() + ": is not valid, and not used");
  }
}

}  // namespace

bool is_bag_name(std::string_view name, std::initializer_list<std::string_view> endings) {
  for (const std::string_view packing : kPackings) {
    if (name.ends_with(packing)) {
      name.remove_suffix(packing.size());
      break;
    }
  }
  return std::any_of(endings.begin(), endings.end(),
                     [&](std::string_view ending) { return name.ends_with(ending); });
}

bool is_bag_folder(const fs::path& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) return false;
  if (!bag_files_in(folder).empty()) return true;
  if (!fs::exists(folder / "metadata.yaml", code)) return false;
  const Expected<std::string> text = read_file(folder / "metadata.yaml");
  return text && text->find("rosbag2_bagfile_information") != text->npos;
}

Expected<BagFolder> read_bag_folder(const fs::path& folder) {
  BagFolder bag;
  read_metadata(folder, bag);
  const std::vector<fs::path> there = bag_files_in(folder);
  if (bag.files.empty()) bag.files = there;
  if (bag.files.empty()) {
    return Error{.message = "has no .mcap or .db3 file",
                 .file = folder.string(),
                 .hint = "give the folder that 'ros2 bag record' wrote, or a file"};
  }
  return bag;
}

}  // namespace pcavr
