// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robot/mesh_reference.hpp"

#include <string_view>
#include <system_error>

namespace pcavr::robot {
namespace {

constexpr std::string_view kPackage = "package://";
constexpr std::string_view kFile = "file://";

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// Of a package below or at `folder`.
std::optional<std::filesystem::path> find_in(const std::filesystem::path& folder,
                                             const std::filesystem::path& package,
                                             const std::filesystem::path& path) {
  if (is_file(folder / package / path)) return folder / package / path;
  if (folder.filename() == package && is_file(folder / path)) return folder / path;
  return std::nullopt;
}

std::optional<std::filesystem::path> find_in_package(
    std::string_view name_and_path, const std::filesystem::path& file,
    const std::vector<std::filesystem::path>& package_folders) {
  const std::size_t slash = name_and_path.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const std::filesystem::path package(name_and_path.substr(0, slash));
  const std::filesystem::path path(name_and_path.substr(slash + 1));
  if (package.empty() || path.is_absolute()) return std::nullopt;
  for (const std::filesystem::path& folder : package_folders) {
    // A trailing slash would leave the folder without a name.
    const std::filesystem::path given = folder.has_filename() ? folder : folder.parent_path();
    if (auto found = find_in(given, package, path)) return found;
  }
  std::error_code failed;
  std::filesystem::path folder = std::filesystem::absolute(file, failed).parent_path();
  while (!failed && !folder.empty()) {
    if (auto found = find_in(folder, package, path)) return found;
    if (folder == folder.root_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::filesystem::path> resolve_mesh(
    const std::string& reference, const std::filesystem::path& file,
    const std::vector<std::filesystem::path>& package_folders) {
  const std::string_view text = reference;
  if (text.find('\0') != std::string_view::npos) return std::nullopt;
  if (text.starts_with(kPackage)) {
    return find_in_package(text.substr(kPackage.size()), file, package_folders);
  }
  const std::filesystem::path path(text.starts_with(kFile) ? text.substr(kFile.size()) : text);
  const std::filesystem::path absolute = path.is_absolute() ? path : file.parent_path() / path;
  if (path.empty() || !is_file(absolute)) return std::nullopt;
  return absolute;
}

}  // namespace pcavr::robot
