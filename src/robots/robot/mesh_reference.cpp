// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot/mesh_reference.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <system_error>

namespace pcavr::robot {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kPackage = "package://";
constexpr std::string_view kFile = "file://";

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

/// Absolute, without "..", and without a trailing slash, which would leave a folder without a name.
fs::path normal(const fs::path& path) {
  std::error_code failed;
  const fs::path full = fs::absolute(path, failed).lexically_normal();
  return full.has_filename() ? full : full.parent_path();
}

/// Whether `path` is in `folder`; both come from normal().
bool is_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

bool is_package(const fs::path& folder) { return is_file(folder / "package.xml"); }

/// The folder with all that belongs to a description: its package, by package.xml or by the usual
/// name of its folder for descriptions; else the folder that it is in.
fs::path root_of_description(const fs::path& folder) {
  for (fs::path above = folder; above.has_relative_path(); above = above.parent_path()) {
    if (is_package(above)) return above;
  }
  const auto usual = {"urdf", "robots"};
  const bool is_usual = std::find(usual.begin(), usual.end(), folder.filename()) != usual.end();
  return is_usual && folder.parent_path().has_relative_path() ? folder.parent_path() : folder;
}

/// A description that someone else wrote may name any file of the disk. What it names is read only
/// below the folders that belong to it, or that the user gave.
class MeshSearch {
 public:
  MeshSearch(const fs::path& file, const std::vector<fs::path>& package_folders)
      : folder_(normal(file).parent_path()), root_(root_of_description(folder_)) {
    for (const fs::path& given : package_folders) given_.push_back(normal(given));
    const char* variable = std::getenv("ROS_PACKAGE_PATH");
    std::string_view rest = variable == nullptr ? "" : variable;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(':'), rest.size());
      if (end > 0) given_.push_back(normal(rest.substr(0, end)));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }

  [[nodiscard]] MeshReference find_path(const fs::path& path) const {
    const fs::path full = normal(path.is_absolute() ? path : folder_ / path);
    if (path.empty() || !is_file(full)) return {};
    const bool is_given =
        std::ranges::any_of(given_, [&](const fs::path& given) { return is_inside(full, given); });
    if (!is_given && !is_inside(full, root_)) return {.file = {}, .is_outside = true};
    return {.file = full};
  }

  [[nodiscard]] MeshReference find_in_package(const fs::path& package, const fs::path& path) const {
    for (const fs::path& given : given_) {
      if (auto found = find_below(given, package, path, true)) return *found;
    }
    for (fs::path above = folder_; !above.empty(); above = above.parent_path()) {
      const bool is_near = above == folder_ || above == root_ || above == root_.parent_path();
      if (auto found = find_below(above, package, path, is_near)) return *found;
      if (above == above.root_path()) break;
    }
    return {};
  }

 private:
  /// Finds the file in a package below or at `folder`. Far from the description, a folder of the
  /// name is a package only if it says so.
  static std::optional<MeshReference> find_below(const fs::path& folder, const fs::path& package,
                                                 const fs::path& path, bool is_near) {
    const fs::path below = folder / package;
    for (const fs::path& root : {below, folder}) {
      if (root == folder && folder.filename() != package) continue;
      const fs::path full = normal(root / path);
      if (!is_file(full)) continue;
      const bool is_allowed =
          is_inside(full, root) && (root == folder || is_near || is_package(root));
      return is_allowed ? MeshReference{.file = full}
                        : MeshReference{.file = {}, .is_outside = true};
    }
    return std::nullopt;
  }

  fs::path folder_;
  fs::path root_;
  std::vector<fs::path> given_;
};

}  // namespace

MeshReference resolve_mesh(const std::string& reference, const fs::path& file,
                           const std::vector<fs::path>& package_folders) {
  std::string_view text = reference;
  if (text.find('\0') != std::string_view::npos) return {};
  const MeshSearch search(file, package_folders);
  if (!text.starts_with(kPackage)) {
    return search.find_path(text.starts_with(kFile) ? text.substr(kFile.size()) : text);
  }
  text.remove_prefix(kPackage.size());
  const std::size_t slash = std::min(text.find('/'), text.size());
  const fs::path package(text.substr(0, slash));
  const fs::path path(text.substr(std::min(slash + 1, text.size())));
  if (package.empty() || package == "." || package == ".." || path.empty() || path.is_absolute()) {
    return {};
  }
  return search.find_in_package(package, path);
}

}  // namespace pcavr::robot
