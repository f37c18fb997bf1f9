// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <span>
#include <string>

#include "pcavr/recordings/recording/text_rows.hpp"
#include "pcavr/recordings/recording/time_series.hpp"
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include "teleoperation/devices/tip_bounds.hpp"

namespace pcavr {
namespace {

const std::vector<std::string> kPositionColumns = {"t", "x", "y", "z"};
const std::vector<std::string> kRotationColumns = {"qx", "qy", "qz", "qw"};
const std::string kEngaged = "engaged";

/// The columns after x, y, z.
struct Columns {
  RowFormat format;
  bool has_rotation = false;
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
  const auto takes = [&](std::span<const std::string> expected) {
    if (names.size() < expected.size() ||
        !std::equal(expected.begin(), expected.end(), names.begin())) {
      return false;
    }
    names = names.subspan(expected.size());
    return true;
  };
  const bool has_position = takes(kPositionColumns);
  columns.has_rotation = has_position && takes(kRotationColumns);
  columns.has_engaged = has_position && takes(std::span(&kEngaged, 1));
  if (has_position && names.empty()) return columns;
  return Error{.message = "has an unexpected header",
               .file = file,
               .line = lines.line(),
               .hint = "write t,x,y,z and optionally qx,qy,qz,qw and engaged after it"};
}

/// Reads a row's numbers after its time. Returns the error, if any.
std::optional<Error> read_row(const Columns& columns, std::span<const double> numbers,
                              TraceSample& sample) {
  sample.p_base_tip = {numbers[0], numbers[1], numbers[2]};
  if (!is_plausible_tip(sample.p_base_tip)) {
    return Error{.message = "lies more than 100 m from the base", .hint = "write metres"};
  }
  if (columns.has_rotation) {
    const std::span<const double> xyzw = numbers.subspan(3, 4);
    if (auto error = check_unit_quaternion(xyzw)) return error;
    sample.q_base_tool = Eigen::Quaterniond(xyzw[3], xyzw[0], xyzw[1], xyzw[2]).normalized();
  }
  if (columns.has_engaged) {
    if (numbers.back() != 0.0 && numbers.back() != 1.0) {
      return Error{.message = "is neither 0 nor 1", .place = kEngaged, .hint = "write 0 or 1"};
    }
    sample.is_engaged = numbers.back() == 1.0;
  }
  return std::nullopt;
}

}  // namespace

Expected<std::vector<TraceSample>> parse_trace(std::string_view text, const std::string& file) {
  LineReader lines(text);
  Columns columns{.format = {.file = file,
                             .separator = RowFormat::Separator::whitespace,
                             .columns = {"t", "x", "y", "z", "qx", "qy", "qz", "qw"}},
                  .has_rotation = true};
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
                         if (auto error = read_row(columns, numbers, sample)) return error;
                         samples.push_back(sample);
                         return std::nullopt;
                       });
  if (!read) return read.error();
  if (samples.empty()) {
    return Error{.message = "has no rows", .file = file, .hint = "write one per sample: t,x,y,z"};
  }
  return samples;
}

}  // namespace pcavr
