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

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// The lines of a text, without their ends (LF or CR LF) and without a UTF-8 byte order mark.
class LineReader {
 public:
  explicit LineReader(std::string_view text);
  /// nullopt after the last line. The view points into the given text.
  [[nodiscard]] std::optional<std::string_view> next();
  /// 1-based number of the line that next() returned last.
  [[nodiscard]] int line() const { return line_; }
  /// Whether that line had a line end; only a text's last line may have none.
  [[nodiscard]] bool has_line_end() const { return has_line_end_; }

 private:
  std::string_view rest_;
  int line_ = 0;
  bool has_line_end_ = true;
};

/// The text without whitespace (space, tab) at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The parts of `line` between the separators, trimmed, in the place of what `fields` had.
void split_at(char separator, std::string_view line, std::vector<std::string_view>& fields);
[[nodiscard]] std::vector<std::string_view> split_at(char separator, std::string_view line);

/// Parses all of `text` as a decimal number. nullopt where it is not one, or not finite.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// The format of a text file's rows: the first column is a stamp, and stamps ascend strictly.
struct RowFormat {
  enum class Separator {
    comma,  ///< CSV: a header line names the columns; no comments
    /// TUM: no header; `#` starts a comment; "..." or a backslash quotes whitespace in a field.
    whitespace,
  };
  std::string file;  ///< named in errors
  Separator separator = Separator::comma;
  std::vector<std::string> columns;  ///< their names, the stamp's first
  bool skip_bad = false;             ///< skip bad rows instead of failing
};

/// An error in one row. The reader adds file and line to the Error.
struct RowFault {
  RowFault(Error error_in, const char* reason_in = "row that can't be used")
      : error(std::move(error_in)), reason(reason_in) {}

  Error error;
  const char* reason;  ///< without values, so that skipped rows can be counted by it
};

/// Callbacks for a row: its fields after the stamp, as text or as finite numbers.
using FieldsHandler =
    std::function<std::optional<RowFault>(Stamp stamp, std::span<const std::string_view> fields)>;
using NumbersHandler =
    std::function<std::optional<RowFault>(Stamp stamp, std::span<const double> numbers)>;

/// Skipped rows and signs of truncation.
struct RowReport {
  /// Skipped bad rows by reason, in the order in which the reasons occurred.
  std::vector<std::pair<std::string, std::size_t>> left_out = {};
  /// The number of the last line where it has no line end and is shorter than the previous rows: it
  /// may be truncated.
  std::optional<int> short_last_line = {};

  void count_skipped(const std::string& reason);
  [[nodiscard]] std::size_t skipped() const;
};

/// Passes each row to `handle`. For CSV, `lines` must be past the header.
[[nodiscard]] Expected<RowReport> read_rows(const RowFormat& format, LineReader& lines,
                                            const FieldsHandler& handle);
[[nodiscard]] Expected<RowReport> read_number_rows(const RowFormat& format, LineReader& lines,
                                                   const NumbersHandler& handle);

/// The names in a CSV file's header, its first line. Fails where there is no line.
[[nodiscard]] Expected<std::vector<std::string>> read_header(const std::string& file,
                                                             LineReader& lines);

}  // namespace pcavr
