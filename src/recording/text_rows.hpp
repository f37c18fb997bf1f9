// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
  /// Whether that line had an end; only a text's last may have none.
  [[nodiscard]] bool has_line_end() const { return has_line_end_; }

 private:
  std::string_view rest_;
  int line_ = 0;
  bool has_line_end_ = true;
};

/// Without blanks (space, tab) at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// A decimal number, all of `text`. Nothing where it is anything else, or not finite.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// How the rows of one text file look: the first column is a stamp, and stamps ascend strictly.
struct RowFormat {
  enum class Separator {
    comma,  ///< CSV: a header line names the columns; no comments
    blank,  ///< TUM: no header; `#` starts a comment; "..." or a backslash keeps a blank in a field
  };
  std::string file;  ///< named in errors
  Separator separator = Separator::comma;
  std::vector<std::string> columns;  ///< their names, the stamp's first
  bool skip_bad = false;             ///< leave bad rows out instead of failing
};

/// What is wrong with one row. The reader adds file and line to the Error.
struct RowFault {
  RowFault(Error error_in, const char* reason_in = "row that can't be used")
      : error(std::move(error_in)), reason(reason_in) {}

  Error error;
  const char* reason;  ///< without values, so that rows left out can be counted by it
};

/// What a row holds after its stamp, as text or as finite numbers.
using TakeFields =
    std::function<std::optional<RowFault>(Stamp stamp, std::span<const std::string_view> fields)>;
using TakeNumbers =
    std::function<std::optional<RowFault>(Stamp stamp, std::span<const double> numbers)>;

/// What was noticed beside the rows themselves.
struct RowReport {
  /// Bad rows left out, by reason in the order in which the reasons came up.
  std::vector<std::pair<std::string, std::size_t>> left_out = {};
  /// The number of the last line where it has no end and is shorter than the rows before it: it may
  /// have been cut.
  std::optional<int> short_last_line = {};

  void leave_out(const std::string& reason);
  [[nodiscard]] std::size_t skipped() const;
};

/// Hands each row on to `take`. For CSV, `lines` must be past the header.
[[nodiscard]] Expected<RowReport> read_rows(const RowFormat& format, LineReader& lines,
                                            const TakeFields& take);
[[nodiscard]] Expected<RowReport> read_number_rows(const RowFormat& format, LineReader& lines,
                                                   const TakeNumbers& take);

/// The names in a CSV file's header, its first line. Fails where there is no line.
[[nodiscard]] Expected<std::vector<std::string>> read_header(const std::string& file,
                                                             LineReader& lines);

}  // namespace pcavr
