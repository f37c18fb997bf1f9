// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

namespace pcavr::model {

/// Buffered reader of a file's bytes and lines: the file is never in memory as a whole.
class ByteReader {
 public:
  /// A file that can't be opened is empty.
  explicit ByteReader(const std::filesystem::path& file);

  /// The next `count` bytes, valid until the next call. Throws MeshFault if the file ends before.
  const char* take(std::size_t count);
  /// At most `count` of the next bytes, which stay to be taken; valid until the next call.
  [[nodiscard]] std::string_view peek(std::size_t count);
  /// The next line without its end (LF or CR LF), valid until the next call; nothing at the end.
  /// Throws MeshFault for a line of more than 1 MB.
  std::optional<std::string_view> line();
  /// Number of the line that line() returned last, 1-based.
  [[nodiscard]] int line_number() const { return line_number_; }
  /// Number of bytes of the file that are not taken yet.
  [[nodiscard]] std::uintmax_t remaining() const { return remaining_; }

 private:
  /// Reads until `min_size` bytes are in the buffer, or the file ends.
  void refill(std::size_t min_size);
  void skip(std::size_t count);

  std::ifstream stream_;
  std::vector<char> buffer_;
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  bool is_at_end_ = false;
  std::uintmax_t remaining_ = 0;
  int line_number_ = 0;
};

/// The words of a line, separated by blanks, in the place of what `words` had.
void split_words(std::string_view line, std::vector<std::string_view>& words);

/// A decimal number, which may have a plus sign or no digit before its point; nothing for any other
/// text. "nan" and "inf" are numbers, too.
[[nodiscard]] std::optional<double> number_of(std::string_view word);

}  // namespace pcavr::model
