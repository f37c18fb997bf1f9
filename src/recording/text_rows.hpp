// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/core/expected.hpp"
#include "pcavr/core/stamp.hpp"

namespace pcavr {

/// The lines of a text, without their ends (LF or CR LF) and without a UTF-8 byte order mark.
class LineReader {
 public:
  explicit LineReader(std::string_view text);
  /// Nothing after the last line. The view points into the text given.
  [[nodiscard]] std::optional<std::string_view> next();
  /// 1-based number of the line that next() returned last.
  [[nodiscard]] int line() const { return line_; }

 private:
  std::string_view rest_;
  int line_ = 0;
};

/// Without blanks (space, tab) at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// A decimal number, all of `text`. Nothing where it is anything else, or not finite.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// How the rows of one text file look: the first column is a stamp, and stamps ascend strictly.
struct RowFormat {
  enum class Separator {
    comma,  ///< CSV: a header line names the columns; no comments
    blank,  ///< TUM: no header; `#` starts a comment
  };
  std::string file;  ///< named in errors
  Separator separator = Separator::comma;
  std::vector<std::string> columns;  ///< their names, the stamp's first
  bool skip_bad = false;             ///< leave bad rows out instead of failing
};

/// What a row holds after its stamp, as text or as finite numbers; what is wrong with it, if
/// anything. The reader adds file and line to the Error.
using TakeFields =
    std::function<std::optional<Error>(Stamp stamp, std::span<const std::string_view> fields)>;
using TakeNumbers =
    std::function<std::optional<Error>(Stamp stamp, std::span<const double> numbers)>;

/// Hands each row on to `take` and returns how many bad ones were left out. For CSV, `lines` must
/// be past the header.
[[nodiscard]] Expected<std::size_t> read_rows(const RowFormat& format, LineReader& lines,
                                              const TakeFields& take);
[[nodiscard]] Expected<std::size_t> read_number_rows(const RowFormat& format, LineReader& lines,
                                                     const TakeNumbers& take);

/// The names in a CSV file's header, its first line. Fails where there is no line.
[[nodiscard]] Expected<std::vector<std::string>> read_header(const std::string& file,
                                                             LineReader& lines);

}  // namespace pcavr
