// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/file_content.hpp"

#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/signal_cleanup.hpp"

#include "base/core/file_descriptor.hpp"
#include "base/core/output_error.hpp"
#include "base/core/partial_names.hpp"

namespace pcavr {
namespace fs = std::filesystem;

namespace {

int write_content(const fs::path& path, int flags, std::string_view content, bool to_disk) {
  // Otherwise a folder that the signal cleanup is removing could be created again.
  wait_if_interrupted();
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | flags, 0644);
  if (file < 0) return errno;
  int failure = 0;
  while (!content.empty() && failure == 0) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno != EINTR) failure = errno;
    if (written > 0) content.remove_prefix(static_cast<std::size_t>(written));
  }
  if (to_disk && failure == 0) failure = sync_file(file);
  if (::close(file) != 0 && failure == 0) failure = errno;
  return failure;
}

}  // namespace

int create_content(const fs::path& path, std::string_view content) {
  // Removes the file of a killed process that had the same id. A link is removed, not the file that
  // it refers to.
  ::unlink(path.c_str());
  return write_content(path, O_CREAT | O_EXCL, content, false);
}

int replace_content(const fs::path& path, std::string_view content) {
  return write_content(path, O_TRUNC, content, true);
}

int sync_file(int file) {
  if (::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS) return 0;
  return errno;
}

Expected<void> write_file(const fs::path& target_in, std::string_view content) {
  const fs::path target = fs::absolute(target_in).lexically_normal();
  const fs::path temporary = PartialNames::sibling_of(target).path(PartialState::partial);
  int failure = create_content(temporary, content);
  if (failure == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) failure = errno;
  if (failure == 0) return {};
  ::unlink(temporary.c_str());
  return can_not_write(target_in, failure);
}

}  // namespace pcavr
