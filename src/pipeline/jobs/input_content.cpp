// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "input_content.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include <fmt/core.h>
#include <sys/stat.h>

#include "sha256.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBlock = 1U << 20U;  // [bytes] read at a time

Error unreadable(const fs::path& path, const std::string& why) {
  return {.message = "can't be read: " + why,
          .file = path.string(),
          .place = {},
          .hint = "check the path and its permissions"};
}

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

Expected<void> add_bytes(const fs::path& file, Sha256& hash) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return unreadable(file, std::strerror(errno));
  std::string block(kBlock, '\0');
  std::error_code code;
  hash.add(fmt::format("{}:", fs::file_size(file, code)));
  if (code) return unreadable(file, code.message());
  while (stream.read(block.data(), static_cast<std::streamsize>(kBlock)) || stream.gcount() > 0) {
    hash.add(std::string_view(block.data(), static_cast<std::size_t>(stream.gcount())));
  }
  if (stream.bad()) return unreadable(file, std::strerror(errno));
  return {};
}

}  // namespace

Expected<std::vector<fs::path>> files_at(const fs::path& path, const std::string& without) {
  std::error_code code;
  if (fs::is_regular_file(path, code)) return std::vector{path};
  std::vector<fs::path> files;
  fs::recursive_directory_iterator entry(path, fs::directory_options::follow_directory_symlink,
                                         code);
  for (const fs::recursive_directory_iterator end; !code && entry != end; entry.increment(code)) {
    const bool is_left_out = is_hidden(entry->path()) || (entry.depth() == 0 && !without.empty() &&
                                                          entry->path().filename() == without);
    if (is_left_out) entry.disable_recursion_pending();
    if (!is_left_out && entry->is_regular_file(code)) files.push_back(entry->path());
  }
  if (code) return unreadable(path, code.message());
  std::ranges::sort(files);
  return files;
}

Expected<std::string> content_of(const std::vector<fs::path>& files, const fs::path& base) {
  Sha256 hash;
  for (const fs::path& file : files) {
    hash.add_text(file.lexically_relative(base).string());
    const Expected<void> added = add_bytes(file, hash);
    if (!added) return added.error();
  }
  return hash.digest();
}

Expected<std::string> listing_of(const std::vector<fs::path>& files, const fs::path& base) {
  Sha256 hash;
  for (const fs::path& file : files) {
    struct stat info {};
    if (::stat(file.c_str(), &info) != 0) return unreadable(file, std::strerror(errno));
    hash.add_text(file.lexically_relative(base).string());
    hash.add_text(fmt::format("{} {} {}", info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec));
  }
  return hash.digest();
}

Expected<InputContent> input_content(const fs::path& path, const std::string& without) {
  const Expected<std::vector<fs::path>> files = files_at(path, without);
  if (!files) return files.error();
  // Listed first: a change while the files are read then shows in the next listing.
  Expected<std::string> listing = listing_of(*files, path);
  if (!listing) return listing.error();
  Expected<std::string> content = content_of(*files, path);
  if (!content) return content.error();
  return InputContent{*std::move(content), *std::move(listing)};
}

Expected<bool> is_unchanged(const InputContent& before, const fs::path& path,
                            const std::string& without) {
  const Expected<std::vector<fs::path>> files = files_at(path, without);
  if (!files) return files.error();
  const Expected<std::string> listing = listing_of(*files, path);
  if (!listing) return listing.error();
  if (*listing == before.listing) return true;
  const Expected<std::string> content = content_of(*files, path);
  if (!content) return content.error();
  return *content == before.content;
}

}  // namespace pcavr
