// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "rosbag/unpacked_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "rosbag/byte_source.hpp"

namespace pcavr {
namespace {

constexpr std::uint64_t kMaxUnpacked = std::uint64_t{1} << 36;

Error unpack_error(const std::filesystem::path& file, std::string message) {
  return {.message = std::move(message),
          .file = file.string(),
          .hint = "unpack it yourself, and give the unpacked file"};
}

}  // namespace

Expected<OpenFile> unpack_file(const std::filesystem::path& file, Compression compression) {
  Expected<ByteSource> source = ByteSource::open(file);
  if (!source) return source.error();
  std::error_code code;
  std::string name = (std::filesystem::temp_directory_path(code) / "pcavr-bag-XXXXXX").string();
  OpenFile unpacked(::mkstemp(name.data()));
  if (!unpacked.is_open()) {
    return unpack_error(name, std::string("can't be created: ") + std::strerror(errno));
  }
  ::unlink(name.c_str());
  std::uint64_t offset = 0;
  const auto feed = [&]() -> Expected<std::span<const std::uint8_t>> {
    constexpr std::uint64_t kPart = 1U << 20;
    const auto size = static_cast<std::size_t>(std::min(kPart, source->size() - offset));
    offset += size;
    return source->view(offset - size, size);
  };
  std::uint64_t written = 0;
  bool is_full = false;
  const auto sink = [&](std::span<const std::uint8_t> piece) {
    for (std::size_t done = 0; done < piece.size();) {
      const ssize_t count = ::write(unpacked.get(), piece.data() + done, piece.size() - done);
      if (count < 0 && errno == EINTR) continue;
      is_full = count <= 0;
      if (is_full) return false;
      done += static_cast<std::size_t>(count);
    }
    written += piece.size();
    return written <= kMaxUnpacked;
  };
  const Expected<void> done = decompress_stream(compression, feed, sink);
  if (is_full) return unpack_error(file, "there is no space for it in the temporary folder");
  if (written > kMaxUnpacked) return unpack_error(file, "has more than 64 GiB unpacked");
  // What a cut file contains is read as a cut bag.
  if (!done && written == 0) return unpack_error(file, done.error().message);
  return unpacked;
}

}  // namespace pcavr
