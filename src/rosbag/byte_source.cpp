// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "rosbag/byte_source.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>

#include "pcavr/core/check.hpp"
#include "pcavr/core/input_file.hpp"

namespace pcavr {
namespace {

/// Read at once, so that small records cost no call of the system each.
constexpr std::size_t kReadAhead = 1U << 20;

}  // namespace

Expected<ByteSource> ByteSource::open(const std::filesystem::path& file, const std::string& name) {
  const Expected<std::uintmax_t> size = regular_file_size(file);
  if (!size) return size.error();
  ByteSource source;
  source.name_ = name.empty() ? file.string() : name;
  source.size_ = *size;
  source.file_ = OpenFile(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!source.file_.is_open()) {
    return Error{.message = std::string("can't be read: ") + std::strerror(errno),
                 .file = source.name_};
  }
  return source;
}

Expected<std::span<const std::uint8_t>> ByteSource::view(std::uint64_t offset, std::size_t count) {
  PCAVR_REQUIRE(offset <= size_ && count <= size_ - offset, offset, count, size_);
  if (!file_.is_open()) return bytes_.subspan(static_cast<std::size_t>(offset), count);
  const bool is_inside = offset >= window_begin_ && offset + count <= window_begin_ + window_size_;
  if (!is_inside) {
    if (const Expected<void> filled = fill(offset, count); !filled) return filled.error();
  }
  return std::span<const std::uint8_t>(window_).subspan(
      static_cast<std::size_t>(offset - window_begin_), count);
}

Expected<void> ByteSource::fill(std::uint64_t offset, std::size_t count) {
  const std::uint64_t wanted = std::min<std::uint64_t>(std::max(count, kReadAhead), size_ - offset);
  window_.resize(std::max(window_.size(), static_cast<std::size_t>(wanted)));
  window_begin_ = offset;
  window_size_ = 0;
  while (window_size_ < wanted) {
    const ssize_t got = ::pread(file_.get(), window_.data() + window_size_,
                                static_cast<std::size_t>(wanted) - window_size_,
                                static_cast<off_t>(offset + window_size_));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return error_at(offset, std::string("can't be read: ") + std::strerror(errno));
    if (got == 0) break;
    window_size_ += static_cast<std::size_t>(got);
  }
  if (window_size_ < count) return error_at(offset, "became shorter while it was read");
  return {};
}

Error ByteSource::error_at(std::uint64_t offset, std::string message, std::string hint) const {
  return {.message = std::move(message),
          .file = name_,
          .place = "byte " + std::to_string(offset),
          .hint = std::move(hint)};
}

}  // namespace pcavr
