// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/file_content.hpp"

#include <cerrno>
#include <functional>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_parts.hpp"
#include "pcavr/base/core/signal_cleanup.hpp"

#include "base/core/file_descriptor.hpp"
#include "base/core/output_error.hpp"
#include "base/core/partial_names.hpp"

namespace pcavr {
namespace fs = std::filesystem;

namespace {

/// Content in parts, until one is empty.
using Parts = std::function<std::string_view()>;

int write_part(int file, std::string_view part) {
  while (!part.empty()) {
    const ssize_t written = ::write(file, part.data(), part.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) part.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int write_content(const fs::path& path, int flags, const Parts& next_part, bool to_disk) {
  // Otherwise a folder that the signal cleanup is removing could be created again.
  wait_if_interrupted();
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | flags, 0644);
  if (file < 0) return errno;
  int failure = 0;
  for (std::string_view part = next_part(); !part.empty() && failure == 0; part = next_part()) {
    failure = write_part(file, part);
  }
  if (to_disk && failure == 0) failure = sync_file(file);
  if (::close(file) != 0 && failure == 0) failure = errno;
  return failure;
}

Parts whole(std::string_view content) {
  return [content]() mutable { return std::exchange(content, {}); };
}

int create_from(const fs::path& path, const Parts& next_part) {
  // Removes the file of a killed process that had the same id. A link is removed, not the file that
  // it refers to.
  ::unlink(path.c_str());
  return write_content(path, O_CREAT | O_EXCL, next_part, false);
}

Expected<void> write_parts(const fs::path& target_in, const Parts& next_part) {
  const fs::path target = fs::absolute(target_in).lexically_normal();
  const fs::path temporary = PartialNames::sibling_of(target).path(PartialState::partial);
  int failure = create_from(temporary, next_part);
  if (failure == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
  if (failure == 0) return {};
  ::unlink(temporary.c_str());
  return can_not_write(target_in, failure);
}

}  // namespace

int create_content(const fs::path& path, std::string_view content) {
  return create_from(path, whole(content));
}

int replace_content(const fs::path& path, std::string_view content) {
  return write_content(path, O_TRUNC, whole(content), true);
}

int append_content(const fs::path& path, std::string_view content) {
  return write_content(path, O_APPEND, whole(content), false);
}

int sync_file(int file) {
  if (::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS) return 0;
  return errno;
}

Expected<void> write_file(const fs::path& target, std::string_view content) {
  return write_parts(target, whole(content));
}

Expected<void> write_file_in_parts(const fs::path& target,
                                   const std::function<std::string()>& next_part) {
  return write_parts(target, [&, part = std::string()]() mutable -> std::string_view {
    part = next_part();
    return part;
  });
}

}  // namespace pcavr
