// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// A file that grows by rows. Rows that a full disk does not take are kept, and written later.
class GrowingFile {
 public:
  /// Appends to an existing file.
  explicit GrowingFile(std::filesystem::path path)
      : path_(std::move(path)),
        file_(::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW)) {}
  GrowingFile(GrowingFile&& other) noexcept
      : path_(std::move(other.path_)),
        file_(std::exchange(other.file_, -1)),
        rows_(std::move(other.rows_)) {}
  GrowingFile& operator=(GrowingFile&&) = delete;
  ~GrowingFile() {
    if (file_ >= 0) ::close(file_);
  }

  /// Buffer for new rows until they are written.
  [[nodiscard]] std::string& rows() { return rows_; }

  /// True if all rows are in the file.
  bool write() noexcept {
    std::size_t done = 0;
    while (done < rows_.size()) {
      const ssize_t count = ::write(file_, rows_.data() + done, rows_.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      done += static_cast<std::size_t>(count);
    }
    rows_.erase(0, done);
    return rows_.empty();
  }

  /// The last rows, and all of them on the disk.
  [[nodiscard]] Expected<void> finish() {
    errno = 0;
    if (write() && ::fsync(file_) == 0) return {};
    return Error{.message = "is not complete: " + std::system_category().message(errno),
                 .file = path_.string(),
                 .hint = "the rows before are there"};
  }

 private:
  std::filesystem::path path_;
  int file_;
  std::string rows_;
};

}  // namespace pcavr
