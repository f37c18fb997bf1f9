// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/unpacked_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fcntl.h>

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kMaxUnpacked = std::uint64_t{1} << 36;
constexpr std::uint64_t kPart = 1U << 20;  // [bytes] read and written at once

Error unpack_error(const std::string& file, std::string message, std::string hint) {
  return {.message = std::move(message), .file = file, .hint = std::move(hint)};
}

/// The size that a database states [www.sqlite.org/fileformat.html, 1.3]; 0 where it has none.
Expected<std::uint64_t> stated_size(ByteSource& source) {
  constexpr std::uint64_t kHeader = 100;
  const Expected<std::uint64_t> there = source.available(0, kHeader);
  if (!there) return there.error();
  if (*there < kHeader) return std::uint64_t{0};
  const auto header = source.view(0, kHeader);
  if (!header) return header.error();
  const auto big_endian = [&](std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = at; i < at + count; ++i) value = 256 * value + (*header)[i];
    return value;
  };
  const std::uint64_t page = big_endian(16, 2);
  return (page == 1 ? 65536 : page) * big_endian(28, 4);
}

Expected<OpenFile> create_temporary(const std::string& file, std::uint64_t size) {
  const char* hint = "set TMPDIR to a folder with space, or unpack it yourself";
  std::error_code code;
  const fs::path folder = fs::temp_directory_path(code);
  if (code) return unpack_error(file, "there is no temporary folder to unpack it to", hint);
  const fs::space_info space = fs::space(folder, code);
  if (size > kMaxUnpacked || (!code && size > space.available)) {
    return unpack_error(file,
                        "has " + std::to_string(size) + " bytes unpacked, but " + folder.string() +
                            " has space for " +
                            std::to_string(std::min<std::uint64_t>(kMaxUnpacked, space.available)),
                        hint);
  }
  std::string name = (folder / "pcavr-bag-XXXXXX").string();
  OpenFile created(::mkostemp(name.data(), O_CLOEXEC));
  if (created.is_open()) {
    ::unlink(name.c_str());
    return created;
  }
  return unpack_error(name, std::string("can't be created: ") + std::strerror(errno), hint);
}

bool write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace

Expected<OpenFile> unpack_database(ByteSource& source) {
  const Expected<std::uint64_t> size = stated_size(source);
  if (!size) return size.error();
  Expected<OpenFile> unpacked = create_temporary(source.name(), *size);
  if (!unpacked) return unpacked;
  for (std::uint64_t written = 0; written < kMaxUnpacked;) {
    const Expected<std::uint64_t> count = source.available(written, kPart);
    if (!count) return count.error();
    if (*count == 0) return unpacked;
    const auto part = source.view(written, static_cast<std::size_t>(*count));
    if (!part) return part.error();
    if (!write_all(unpacked->get(), *part)) {
      return unpack_error(source.name(), "there is no space for it in the temporary folder",
                          "set TMPDIR to a folder with space, or unpack it yourself");
    }
    written += *count;
  }
  return unpack_error(source.name(), "has more than 64 GiB unpacked", "unpack it yourself");
}

}  // namespace pcavr
