// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/byte_source.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include <fcntl.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/input_file.hpp"

namespace pcavr {
namespace {

/// Read at once, so that small records cost no call of the system each.
constexpr std::size_t kReadAhead = 1U << 20;

}  // namespace

/// The state for unpacking a file piece by piece; the feed points to it.
struct ByteSource::Packed {
  Packed(ByteSource stored, Compression compression)
      : file(std::move(stored)), stream(compression, [this] { return next_part(); }) {}

  Expected<std::span<const std::uint8_t>> next_part() {
    const Expected<std::uint64_t> size = file.available(fed, kReadAhead);
    if (!size) return size.error();
    fed += *size;
    return file.view(fed - *size, static_cast<std::size_t>(*size));
  }

  ByteSource file;
  std::uint64_t fed = 0;  ///< [bytes]
  UnpackedStream stream;
  std::uint64_t unpacked = 0;  ///< [bytes]
  bool is_at_end = false;
};

ByteSource::ByteSource(std::string name) : name_(std::move(name)) {}
ByteSource::ByteSource(std::span<const std::uint8_t> bytes, std::string name)
    : bytes_(bytes), size_(bytes.size()), name_(std::move(name)) {}
ByteSource::ByteSource(ByteSource&&) noexcept = default;
ByteSource::~ByteSource() = default;

Expected<ByteSource> ByteSource::open(const std::filesystem::path& file, const std::string& name) {
  const Expected<std::uintmax_t> size = regular_file_size(file);
  if (!size) return size.error();
  ByteSource source(name.empty() ? file.string() : name);
  source.size_ = *size;
  source.file_ = OpenFile(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!source.file_.is_open()) {
    return Error{.message = std::string("can't be read: ") + std::strerror(errno),
                 .file = source.name_};
  }
  return source;
}

Expected<ByteSource> ByteSource::open_packed(const std::filesystem::path& file,
                                             Compression compression) {
  Expected<ByteSource> stored = open(file);
  if (!stored) return stored.error();
  ByteSource source(file.string());
  source.packed_ = std::make_unique<Packed>(*std::move(stored), compression);
  return source;
}

std::uint64_t ByteSource::stored_size() const { return packed_ ? packed_->file.size_ : size_; }

Expected<std::uint64_t> ByteSource::available(std::uint64_t offset, std::uint64_t count) {
  if (!packed_) return offset < size_ ? std::min(count, size_ - offset) : 0;
  if (!is_in_window(offset, count)) {
    const Expected<void> filled = fill(offset, static_cast<std::size_t>(count));
    if (!filled) return filled.error();
  }
  const std::uint64_t end = window_begin_ + window_size_;
  return offset < end ? std::min(count, end - offset) : 0;
}

Expected<std::uint64_t> ByteSource::skip(std::uint64_t offset, std::uint64_t count) {
  if (!packed_) return available(offset, count);
  const std::uint64_t end =
      offset + std::min(count, std::numeric_limits<std::uint64_t>::max() - offset);
  if (const Expected<void> done = unpack_to(end); !done) return done.error();
  return std::max(offset, std::min(end, window_begin_ + window_size_)) - offset;
}

Expected<std::span<const std::uint8_t>> ByteSource::view(std::uint64_t offset, std::size_t count) {
  if (!packed_) {
    PCAVR_REQUIRE(offset <= size_ && count <= size_ - offset, offset, count, size_);
    if (!file_.is_open()) return bytes_.subspan(static_cast<std::size_t>(offset), count);
  }
  if (!is_in_window(offset, count)) {
    if (const Expected<void> filled = fill(offset, count); !filled) return filled.error();
  }
  PCAVR_REQUIRE(is_in_window(offset, count), offset, count, window_begin_, window_size_);
  return std::span<const std::uint8_t>(window_).subspan(
      static_cast<std::size_t>(offset - window_begin_), count);
}

bool ByteSource::is_in_window(std::uint64_t offset, std::uint64_t count) const {
  return offset >= window_begin_ && offset - window_begin_ <= window_size_ &&
         count <= window_size_ - (offset - window_begin_);
}

/// Discards the bytes before the offset, or all, where there are fewer.
Expected<void> ByteSource::unpack_to(std::uint64_t offset) {
  while (offset > window_begin_ + window_size_ && !packed_->is_at_end) {
    window_begin_ += window_size_;
    window_size_ = 0;
    if (const Expected<void> done = unpack_more(kReadAhead); !done) return done;
  }
  const auto dropped =
      static_cast<std::size_t>(std::min<std::uint64_t>(offset - window_begin_, window_size_));
  std::copy(window_.begin() + static_cast<std::ptrdiff_t>(dropped),
            window_.begin() + static_cast<std::ptrdiff_t>(window_size_), window_.begin());
  window_begin_ += dropped;
  window_size_ -= dropped;
  return {};
}

/// Unpacks until the window has `count` bytes or the data end.
Expected<void> ByteSource::unpack_more(std::size_t count) {
  window_.reserve(count);  // memory is taken as it is filled
  while (window_size_ < count && !packed_->is_at_end) {
    window_.resize(std::max(window_.size(), std::min(count, window_size_ + kReadAhead)));
    const Expected<std::size_t> got =
        packed_->stream.read(std::span(window_).subspan(window_size_));
    if (!got && packed_->unpacked == 0) {
      return error_at(0, got.error().message, "copy it again, or unpack it yourself");
    }
    packed_->is_at_end = !got || *got == 0;
    if (packed_->is_at_end) break;
    window_size_ += *got;
    packed_->unpacked += *got;
    if (packed_->unpacked <= max_unpacked_size(stored_size())) continue;
    return error_at(packed_->unpacked,
                    "its " + std::to_string(stored_size()) +
                        " bytes unpack to more than 1000 times as many and 256 MiB",
                    "no recording does; unpack it yourself if it is one");
  }
  return {};
}

Expected<void> ByteSource::fill(std::uint64_t offset, std::size_t count) {
  if (packed_) {
    PCAVR_REQUIRE(offset >= window_begin_, offset, window_begin_);
    if (const Expected<void> done = unpack_to(offset); !done) return done;
    return unpack_more(std::max(count, kReadAhead));
  }
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
