// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <span>
#include <string>

#include "pcavr/devices/trace_device.hpp"

#include "devices/tip_bounds.hpp"
#include "recording/text_rows.hpp"
#include "recording/time_series.hpp"

namespace pcavr {
namespace {

const std::vector<std::string> kPlace = {"t", "x", "y", "z"};
const std::vector<std::string> kRotationColumns = {"qx", "qy", "qz", "qw"};
const std::string kEngaged = "engaged";

/// What the columns after x, y, z are.
struct Columns {
  RowFormat format;
  bool has_turn = false;
  bool has_engaged = false;
};

bool is_csv(std::string_view text) {
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::string_view content = trimmed(line->substr(0, line->find('#')));
    if (!content.empty()) return content.find(',') != content.npos;
  }
  return false;
}

Expected<Columns> columns_of(const std::string& file, LineReader& lines) {
  const auto header = read_header(file, lines);
  if (!header) return header.error();
  Columns columns{.format = {.file = file, .columns = *header}};
  std::span<const std::string> names = *header;
  const auto takes = [&](std::span<const std::string> wanted) {
    if (names.size() < wanted.size() || !std::equal(wanted.begin(), wanted.end(), names.begin())) {
      return false;
    }
    names = names.subspan(wanted.size());
    return true;
  };
  const bool has_place = takes(kPlace);
  columns.has_turn = has_place && takes(kRotationColumns);
  columns.has_engaged = has_place && takes(std::span(&kEngaged, 1));
  if (has_place && names.empty()) return columns;
  return Error{.message = "has another header",
               .file = file,
               .line = lines.line(),
               .hint = "write t,x,y,z and after it, where it is known, qx,qy,qz,qw and engaged"};
}

/// A row's numbers after its time. What is wrong with them, if anything.
std::optional<Error> take_row(const Columns& columns, std::span<const double> numbers,
                              TraceSample& sample) {
  sample.p_base_tip = {numbers[0], numbers[1], numbers[2]};
  if (!is_plausible_tip(sample.p_base_tip)) {
    return Error{.message = "lies more than 100 m from the base", .hint = "write metres"};
  }
  if (columns.has_turn) {
    const std::span<const double> xyzw = numbers.subspan(3, 4);
    if (auto error = check_unit_quaternion(xyzw)) return error;
    sample.q_base_tool = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
  }
  if (columns.has_engaged) {
    if (numbers.back() != 0.0 && numbers.back() != 1.0) {
      return Error{
          .message = "is neither engaged nor not", .place = kEngaged, .hint = "write 0 or 1"};
    }
    sample.is_engaged = numbers.back() == 1.0;
  }
  return std::nullopt;
}

}  // namespace

Expected<std::vector<TraceSample>> parse_trace(std::string_view text, const std::string& file) {
  LineReader lines(text);
  Columns columns{.format = {.file = file,
                             .separator = RowFormat::Separator::blank,
                             .columns = {"t", "x", "y", "z", "qx", "qy", "qz", "qw"}},
                  .has_turn = true};
  if (is_csv(text)) {
    Expected<Columns> of_header = columns_of(file, lines);
    if (!of_header) return of_header.error();
    columns = *std::move(of_header);
  }
  std::vector<TraceSample> samples;
  std::optional<Stamp> first;
  const auto read =
      read_number_rows(columns.format, lines,
                       [&](Stamp stamp, std::span<const double> numbers) -> std::optional<Error> {
                         if (!first) first = stamp;
                         TraceSample sample{.t = to_seconds(stamp - *first)};
                         if (auto error = take_row(columns, numbers, sample)) return error;
                         samples.push_back(sample);
                         return std::nullopt;
                       });
  if (!read) return read.error();
  if (samples.empty()) {
    return Error{.message = "has no rows", .file = file, .hint = "write one a moment: t,x,y,z"};
  }
  return samples;
}

}  // namespace pcavr
