// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>

#include "pcavr/base/core/check.hpp"

#include "fuzz/memory_file.hpp"
#include "fuzz/targets.hpp"
#include "recordings/bag_import/csv_rows.hpp"

namespace pcavr::fuzz {
namespace {

void expect_line(const Error& error) {
  PCAVR_REQUIRE(error.line > 0 && !error.message.empty() && !error.hint.empty(), error.to_string());
}

void read_row(const CsvRows& rows, const CsvLayout& layout) {
  for (const CsvLayout::StampColumn* column : {&layout.stamp, &layout.log_time}) {
    const Expected<Stamp> stamp = rows.stamp(*column);
    if (!stamp) expect_line(stamp.error());
  }
  for (const CsvLayout::Series& series : layout.series) {
    if (rows.is_gap(series)) continue;
    const Expected<std::vector<double>> numbers = rows.numbers(series);
    if (!numbers) {
      expect_line(numbers.error());
      continue;
    }
    for (const double number : *numbers) PCAVR_REQUIRE(std::isfinite(number), number);
  }
}

}  // namespace

void csv(std::string_view bytes) {
  CsvOptions options;
  if (bytes.starts_with('z')) options.up = 'z';
  if (bytes.starts_with('m')) options = {.columns = {{"fx", "a"}}, .units = {{"fx", "kn"}}};
  const std::string_view text = bytes.substr(bytes.empty() ? 0 : 1);
  const Expected<CsvLayout> layout = layout_of(text, options);
  if (!layout) {
    PCAVR_REQUIRE(!layout.error().message.empty(), layout.error().to_string());
    return;
  }
  if (layout->series.empty()) return;
  const MemoryFile file(text);
  const std::filesystem::path path = file.path();
  Expected<CsvRows> rows = CsvRows::open(path, *layout);
  PCAVR_REQUIRE(rows.has_value());
  while (rows->next()) {
    if (const Expected<void> width = rows->check_width(); !width) {
      expect_line(width.error());
    } else {
      read_row(*rows, *layout);
    }
  }
}

}  // namespace pcavr::fuzz
