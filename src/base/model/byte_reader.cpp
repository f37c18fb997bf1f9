// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/model/byte_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>
#include <system_error>

#include "base/model/mesh_fault.hpp"

namespace pcavr::model {
namespace {

constexpr std::size_t kChunk = 1U << 20U;          // bytes per read; fewer of a smaller file
constexpr std::size_t kMinChunk = 1U << 12U;       // bytes
constexpr std::size_t kMaxLine = 1U << 20U;        // bytes; a polygon of 4096 corners takes 100 kB
constexpr std::string_view kBlanks = " \t\r\f\v";  // between words; CR ends lines of old systems

}  // namespace

ByteReader::ByteReader(const std::filesystem::path& file) : stream_(file, std::ios::binary) {
  std::error_code code;
  remaining_ = std::filesystem::file_size(file, code);
  if (code) remaining_ = 0;
}

const char* ByteReader::take(std::size_t count) {
  if (end_ - next_ < count && count <= remaining_) refill(count);
  if (end_ - next_ < count) {
    throw MeshFault("it is truncated: " + std::to_string(count) + " bytes are expected where " +
                    std::to_string(remaining_) + " are left");
  }
  const char* bytes = buffer_.data() + next_;
  skip(count);
  return bytes;
}

std::string_view ByteReader::peek(std::size_t count) {
  if (end_ - next_ < count) refill(count);
  return {buffer_.data() + next_, std::min(count, end_ - next_)};
}

std::optional<std::string_view> ByteReader::line() {
  std::size_t searched = 0;
  for (;;) {
    const char* begin = buffer_.data() + next_;
    const std::size_t size = end_ - next_;
    const void* found =
        size > searched ? std::memchr(begin + searched, '\n', size - searched) : nullptr;
    if (found == nullptr && size > kMaxLine) {
      throw MeshFault("a line has more than 1 MB", line_number_ + 1);
    }
    if (found != nullptr || (is_at_end_ && size > 0)) {
      const std::size_t length =
          found == nullptr ? size
                           : static_cast<std::size_t>(static_cast<const char*>(found) - begin);
      skip(length + (found != nullptr ? 1 : 0));
      ++line_number_;
      std::string_view text(begin, length);
      if (text.ends_with('\r')) text.remove_suffix(1);
      return text;
    }
    if (is_at_end_) return std::nullopt;
    searched = size;
    refill(size + 1);
  }
}

void ByteReader::refill(std::size_t min_size) {
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(next_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
  end_ -= next_;
  next_ = 0;
  const auto chunk =
      static_cast<std::size_t>(std::clamp<std::uintmax_t>(remaining_, kMinChunk, kChunk));
  buffer_.resize(std::max(buffer_.size(), min_size + chunk));
  stream_.read(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
  end_ += static_cast<std::size_t>(stream_.gcount());
  is_at_end_ = !stream_;
}

void ByteReader::skip(std::size_t count) {
  next_ += count;
  remaining_ -= std::min<std::uintmax_t>(count, remaining_);
}

void split_words(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == line.npos) return;
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

std::optional<double> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  // Below the smallest double, the number is zero for every use.
  const bool is_tiny = code == std::errc::result_out_of_range && word.find("e-") != word.npos;
  if ((code != std::errc{} && !is_tiny) || end != word.data() + word.size()) return std::nullopt;
  return is_tiny ? 0.0 : value;
}

}  // namespace pcavr::model
