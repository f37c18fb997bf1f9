// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "step_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kPart = 1U << 22U;  // [bytes] written or read at a time
constexpr std::size_t kDigestSize = 64;

Error refused(const fs::path& file, const std::string& why) {
  return {
      .message = why, .file = file.string(), .place = {}, .hint = "run the step before it again"};
}

/// The digest of the first `size` bytes; the stream is after them.
std::string digest_of(std::ifstream& stream, std::uint64_t size) {
  Sha256 hash;
  std::string part;
  while (size > 0 && stream) {
    part.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, kPart)));
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    hash.add(part);
    size -= part.size();
  }
  return hash.digest();
}

}  // namespace

StepFileWriter::StepFileWriter(std::string_view format, const WriteContent& write) : write_(write) {
  add_bytes(format);
}

void StepFileWriter::add_bytes(std::string_view bytes) {
  buffer_ += bytes;
  if (buffer_.size() >= kPart) flush();
}

void StepFileWriter::flush() {
  hash_.add(buffer_);
  if (written_) written_ = write_(buffer_);
  buffer_.clear();
}

Expected<std::string> StepFileWriter::finish() {
  flush();
  const std::string digest = hash_.digest();
  if (written_) written_ = write_(digest);
  if (!written_) return written_.error();
  return digest;
}

Expected<StepFileReader> StepFileReader::open(const fs::path& file, std::string_view format) {
  std::error_code code;
  const std::uint64_t size = fs::file_size(file, code);
  if (code) return refused(file, "can't be read: " + code.message());
  StepFileReader reader;
  reader.path_ = file;
  reader.stream_.open(file, std::ios::binary);
  if (!reader.stream_) return refused(file, std::string("can't be read: ") + std::strerror(errno));
  std::string begin(format.size(), '\0');
  reader.stream_.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin != format || size < format.size() + kDigestSize)
    return refused(file, "is no file of this step, or of another version");
  reader.stream_.seekg(0);
  const std::string digest = digest_of(reader.stream_, size - kDigestSize);
  reader.digest_.resize(kDigestSize);
  reader.stream_.read(reader.digest_.data(), kDigestSize);
  if (!reader.stream_ || digest != reader.digest_)
    return refused(file, "is damaged: its SHA-256 is another one");
  reader.stream_.seekg(static_cast<std::streamoff>(format.size()));
  reader.left_ = size - kDigestSize - format.size();
  return reader;
}

void StepFileReader::take_bytes(char* bytes, std::size_t size) {
  if (size > left_) throw std::out_of_range("ends too early");
  stream_.read(bytes, static_cast<std::streamsize>(size));
  if (!stream_) throw std::out_of_range("can't be read to its end");
  left_ -= size;
}

std::size_t StepFileReader::take_count(std::size_t size) {
  std::uint64_t count = 0;
  (*this)(count);
  if (count > left_ / size) throw std::out_of_range("ends too early");
  return static_cast<std::size_t>(count);
}

}  // namespace pcavr
