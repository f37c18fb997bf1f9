// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/output_paths.hpp"

#include <algorithm>
#include <cerrno>
#include <deque>
#include <optional>
#include <string>

#include <sys/stat.h>

#include "base/core/output_error.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxLinks = 40;  ///< as the kernel's own limit

struct FileId {
  dev_t device = 0;
  ino_t inode = 0;
  bool operator==(const FileId&) const = default;
};

std::optional<FileId> file_id(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  return FileId{status.st_dev, status.st_ino};
}

/// A path as given, and with symbolic links resolved.
struct ResolvedPath {
  fs::path given;
  fs::path resolved;
  std::optional<FileId> id;  ///< where it exists
};

ResolvedPath with_file_id(const fs::path& given, fs::path resolved) {
  std::optional<FileId> id = file_id(resolved);
  return {given, std::move(resolved), id};
}

/// Compares the names, and device and inode of each existing parent folder.
bool is_within(const ResolvedPath& inner, const ResolvedPath& outer) {
  for (fs::path folder = inner.resolved;; folder = folder.parent_path()) {
    if (folder == outer.resolved) return true;
    if (outer.id && file_id(folder) == outer.id) return true;
    if (!folder.has_relative_path()) return false;
  }
}

/// A text that says how an output overlaps another path; empty where it does not.
std::string overlap(const ResolvedPath& output, const ResolvedPath& other,
                    const std::string& what) {
  const bool is_inside = is_within(output, other);
  const bool is_outside = is_within(other, output);
  if (!is_inside && !is_outside) return {};
  const char* relation = is_inside && is_outside ? "is" : (is_inside ? "lies in" : "contains");
  return std::string(relation) + " the " + what + " " + other.given.string();
}

Error overlapping(const fs::path& output, std::string message) {
  return {.message = std::move(message),
          .file = output.string(),
          .hint = "choose another path for the output"};
}

}  // namespace

Expected<fs::path> resolve_path(const fs::path& path) {
  if (path.empty()) {
    return Error{.message = "the name of the output is empty", .hint = "name a file or folder"};
  }
  std::error_code code;
  const fs::path absolute = fs::absolute(path, code);
  if (code) return can_not_write(path, code);
  std::deque<fs::path> parts(absolute.begin(), absolute.end());
  fs::path resolved = "/";
  int links = 0;
  while (!parts.empty()) {
    const fs::path part = parts.front();
    parts.pop_front();
    if (part.empty() || part == "." || part.is_absolute()) continue;
    if (part == "..") {
      resolved = resolved.parent_path();
      continue;
    }
    const fs::path next = resolved / part;
    struct stat status {};
    if (::lstat(next.c_str(), &status) != 0 && errno != ENOENT) {
      return can_not_write(path, errno);
    }
    if (!S_ISLNK(status.st_mode)) {
      resolved = next;
      continue;
    }
    if (++links > kMaxLinks) return can_not_write(path, ELOOP);
    const fs::path target = fs::read_symlink(next, code);
    if (code) return can_not_write(path, code);
    if (target.is_absolute()) resolved = "/";
    parts.insert(parts.begin(), target.begin(), target.end());
  }
  return resolved;
}

Expected<void> check_outputs(const std::vector<fs::path>& outputs,
                             const std::vector<fs::path>& inputs) {
  std::vector<ResolvedPath> read;
  for (const fs::path& input : inputs) {
    // An input that does not resolve can't be read either: the reader reports that.
    const Expected<fs::path> resolved =
        input.empty() ? Expected<fs::path>(input) : resolve_path(input);
    if (resolved && !resolved->empty()) read.push_back(with_file_id(input, *resolved));
  }
  std::vector<ResolvedPath> written;
  for (const fs::path& output : outputs) {
    const Expected<fs::path> resolved = resolve_path(output);
    if (!resolved) return resolved.error();
    const ResolvedPath written_path = with_file_id(output, *resolved);
    for (const ResolvedPath& input : read) {
      std::string message = overlap(written_path, input, "input");
      if (!message.empty()) return overlapping(output, std::move(message));
    }
    for (const ResolvedPath& earlier : written) {
      std::string message = overlap(written_path, earlier, "other output");
      if (!message.empty()) return overlapping(output, std::move(message));
    }
    written.push_back(written_path);
  }
  return {};
}

}  // namespace pcavr
