// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/core/output.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// A sibling of `target`, so that the rename stays within one file system.
fs::path temporary_name(const fs::path& target) {
  return target.parent_path() /
         ("." + target.filename().string() + ".partial-" + std::to_string(::getpid()));
}

/// Without a trailing slash, so that filename() is the folder's name.
fs::path normalised(const fs::path& target) {
  const fs::path path = fs::absolute(target).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

Error can_not_write(const fs::path& path, const std::string& reason) {
  return {.message = "can't be written: " + reason,
          .file = path.string(),
          .hint = "choose a folder that you may write to, on a disk with space left"};
}

}  // namespace

Expected<OutputFolder> OutputFolder::create(const fs::path& target_in, bool replace) {
  const fs::path target = normalised(target_in);
  std::error_code code;
  if (fs::exists(target, code)) {
    if (!fs::is_directory(target, code)) {
      return Error{.message = "is there already, and is not a folder",
                   .file = target_in.string(),
                   .hint = "choose another name for the output"};
    }
    if (!replace && !fs::is_empty(target, code)) {
      return Error{.message = "is there already, and is not empty",
                   .file = target_in.string(),
                   .hint = "choose another name, or say --force to replace it"};
    }
  }
  const fs::path temporary = temporary_name(target);
  fs::remove_all(temporary, code);
  fs::create_directories(temporary, code);
  if (code) return can_not_write(target_in, code.message());
  return OutputFolder(target, temporary, replace);
}

OutputFolder::OutputFolder(fs::path target, fs::path temporary, bool replace)
    : target_(std::move(target)), temporary_(std::move(temporary)), replace_(replace) {}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      replace_(other.replace_) {}

OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept {
  std::swap(target_, other.target_);
  std::swap(temporary_, other.temporary_);
  std::swap(replace_, other.replace_);
  return *this;
}

OutputFolder::~OutputFolder() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

Expected<void> OutputFolder::commit() {
  PCAVR_REQUIRE(!temporary_.empty());
  std::error_code code;
  if (replace_) fs::remove_all(target_, code);
  if (!code) fs::rename(temporary_, target_, code);
  if (code) return can_not_write(target_, code.message());
  temporary_.clear();
  return {};
}

Expected<void> write_file(const fs::path& target_in, std::string_view content) {
  const fs::path target = normalised(target_in);
  const fs::path temporary = temporary_name(target);
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) return can_not_write(target_in, std::strerror(errno));
  int failure = 0;
  while (!content.empty() && failure == 0) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno != EINTR) failure = errno;
    if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::close(file) != 0 && failure == 0) failure = errno;
  if (failure == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
  if (failure == 0) return {};
  ::unlink(temporary.c_str());
  return can_not_write(target_in, std::strerror(failure));
}

Expected<std::string> read_file(const fs::path& path) {
  std::error_code code;
  if (fs::is_directory(path, code)) {
    return Error{.message = "is a folder, not a file", .file = path.string()};
  }
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    return Error{.message = std::string("can't be read: ") + std::strerror(errno),
                 .file = path.string(),
                 .hint = "check the name, and that you may read it"};
  }
  // The size is a guess that saves copies: special files have none.
  const std::uintmax_t guess = fs::file_size(path, code);
  std::string content(code ? 0 : static_cast<std::size_t>(guess), '\0');
  stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream) content.append(std::istreambuf_iterator<char>(stream), {});
  if (stream.bad()) {
    return Error{.message = "could not be read to its end", .file = path.string()};
  }
  return content;
}

}  // namespace pcavr
