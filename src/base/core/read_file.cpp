// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Largest size of a file that is read into memory [byte]: ten hours of force at 1 kHz as text are
/// a tenth of it. Prevents a sparse file of a terabyte from exhausting the memory.
constexpr std::uintmax_t kMaxFileSize = std::uintmax_t{8} << 30;

Error can_not_read(const fs::path& path, int code) {
  return {.message = std::string("can't be read: ") + std::strerror(code),
          .file = path.string(),
          .hint = "check the name, and that you may read it"};
}

Error not_regular(const fs::path& path, const char* kind) {
  return {.message = std::string("is ") + kind + ", not a regular file",
          .file = path.string(),
          .hint = "write the data into a file first, and name that"};
}

/// The kind of a path that is not a regular file.
const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a named pipe";
  if (S_ISSOCK(mode)) return "a socket";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  return "a special file";
}

/// An open regular file (RAII).
class InputFile {
 public:
  [[nodiscard]] static Expected<InputFile> open(const fs::path& path) {
    // Non-blocking: opening a pipe without a writer would block.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) {
      const int code = errno;
      // A socket can't be opened at all.
      struct stat socket {};
      if (code == ENXIO && ::stat(path.c_str(), &socket) == 0) {
        return not_regular(path, kind_of(socket.st_mode));
      }
      return can_not_read(path, code);
    }
    InputFile file(descriptor);
    struct stat status {};
    if (::fstat(descriptor, &status) != 0) return can_not_read(path, errno);
    if (!S_ISREG(status.st_mode)) return not_regular(path, kind_of(status.st_mode));
    file.size_ = static_cast<std::uintmax_t>(status.st_size);
    return file;
  }

  InputFile(InputFile&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  /// The size that the file system reports; 0 for the virtual files of /proc.
  [[nodiscard]] std::uintmax_t size() const { return size_; }

  /// Up to `size` bytes into `to`; fewer at the file's end. -1 with errno where it fails.
  [[nodiscard]] ssize_t read(char* to, std::size_t size) const {
    std::size_t filled = 0;
    while (filled < size) {
      const ssize_t count = ::read(descriptor_, to + filled, size - filled);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return -1;
      if (count == 0) break;
      filled += static_cast<std::size_t>(count);
    }
    return static_cast<ssize_t>(filled);
  }

 private:
  explicit InputFile(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
  std::uintmax_t size_ = 0;
};

Error too_large(const fs::path& path, const std::string& why) {
  return {.message = "is too large to be read: " + why,
          .file = path.string(),
          .hint = "check that this is the intended file"};
}

}  // namespace

Expected<bool> is_present(const fs::path& path) {
  std::error_code code;
  if (fs::exists(path, code)) return true;
  if (code) return can_not_read(path, code.value());
  if (fs::is_symlink(fs::symlink_status(path, code))) {
    return Error{.message = "is a symbolic link to a file that is missing",
                 .file = path.string(),
                 .hint = "correct the link, or remove it"};
  }
  return false;
}

std::string fault_of_listed(const fs::path& path) {
  const Expected<bool> present = is_present(path);
  if (present && !*present) return "is missing";
  const Expected<std::uintmax_t> size = regular_file_size(path);
  return size ? std::string() : size.error().message;
}

Expected<std::uintmax_t> regular_file_size(const fs::path& path) {
  const Expected<InputFile> file = InputFile::open(path);
  if (!file) return file.error();
  return file->size();
}

Expected<std::string> read_file(const fs::path& path) {
  const Expected<InputFile> file = InputFile::open(path);
  if (!file) return file.error();
  if (file->size() > kMaxFileSize) {
    return too_large(path, "it has " + std::to_string(file->size()) + " bytes");
  }
  try {
    std::string content(static_cast<std::size_t>(file->size()), '\0');
    ssize_t count = file->read(content.data(), content.size());
    if (count < 0) return can_not_read(path, errno);
    content.resize(static_cast<std::size_t>(count));
    // The size only saves copies: a file may grow, and those of /proc report none.
    std::array<char, 4096> rest{};
    while ((count = file->read(rest.data(), rest.size())) > 0) {
      content.append(rest.data(), static_cast<std::size_t>(count));
      if (content.size() > kMaxFileSize) return too_large(path, "it does not end");
    }
    if (count < 0) return can_not_read(path, errno);
    return content;
  } catch (const std::bad_alloc&) {
    return too_large(
        path, "there is not enough memory for its " + std::to_string(file->size()) + " bytes");
  }
}

}  // namespace pcavr
