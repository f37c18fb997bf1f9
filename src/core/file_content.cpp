// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "core/file_content.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pcavr/core/output.hpp"
#include "pcavr/core/signal_cleanup.hpp"

#include "core/file_descriptor.hpp"
#include "core/output_error.hpp"
#include "core/partial_names.hpp"

namespace pcavr {
namespace fs = std::filesystem;

int write_content(const fs::path& path, std::string_view content, bool to_disk) {
  // Else a folder might be made anew that is just being removed.
  wait_if_interrupted();
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
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

int sync_file(int file) {
  if (::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS) return 0;
  return errno;
}

Expected<void> write_file(const fs::path& target_in, std::string_view content) {
  const fs::path target = fs::absolute(target_in).lexically_normal();
  const fs::path temporary = PartialNames::beside(target).path(PartialState::partial);
  int failure = write_content(temporary, content, false);
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
