// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

#include "pcavr/base/core/check.hpp"

namespace pcavr::fuzz {

/// A file in memory, open as long as this lives.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    PCAVR_REQUIRE(descriptor_ >= 0);
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    PCAVR_REQUIRE(written == static_cast<ssize_t>(bytes.size()), written);
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace pcavr::fuzz
