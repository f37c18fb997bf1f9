// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "recordings/bag_import/csv_layout.hpp"

namespace pcavr {

/// The rows of a CSV file, one after the other, in memory. Errors name file, line and column.
class CsvRows {
 public:
  /// Keeps references to `file` and `layout`, which must outlive it.
  static Expected<CsvRows> open(const std::filesystem::path& file, const CsvLayout& layout);

  /// Goes to the next row that has content; false at the end.
  bool next();
  /// An Error where the row is not as wide as the header.
  [[nodiscard]] Expected<void> check_width() const;
  /// Since 1970 where the file's stamps are, or from the file's own start.
  [[nodiscard]] Expected<Stamp> stamp(const CsvLayout::StampColumn& column) const;
  /// Whether the row has no sample of a series.
  [[nodiscard]] bool is_gap(const CsvLayout::Series& series) const;
  /// The numbers of the series' message of ROS [SI].
  [[nodiscard]] Expected<std::vector<double>> numbers(const CsvLayout::Series& series) const;

 private:
  CsvRows(const std::filesystem::path& file, const CsvLayout& layout, std::string text);

  [[nodiscard]] Error error_at(std::string message) const;
  [[nodiscard]] Expected<double> number(std::size_t column) const;
  [[nodiscard]] Expected<Stamp> date(const CsvLayout::StampColumn& column) const;
  [[nodiscard]] Expected<Stamp> decimal_stamp(const CsvLayout::StampColumn& column) const;

  const std::filesystem::path* file_;
  const CsvLayout* layout_;
  std::unique_ptr<std::string> text_;  ///< `lines_` views it
  LineReader lines_;
  std::vector<std::string> fields_;
};

}  // namespace pcavr
