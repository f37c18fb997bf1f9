// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/time_series.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/recording/joint_log.hpp"

namespace pcavr {
namespace {

using Separator = RowFormat::Separator;

RowFormat format_of(const SeriesText& text, Separator separator, std::vector<std::string> columns) {
  return {text.file, separator, std::move(columns), text.skip_bad};
}

/// Reads the header line and compares it with the columns that the format requires.
Expected<void> expect_header(const RowFormat& format, LineReader& lines) {
  const Expected<std::vector<std::string>> header = read_header(format.file, lines);
  if (!header) return header.error();
  if (*header == format.columns) return {};
  std::string expected;
  for (const std::string& column : format.columns)
    expected += (expected.empty() ? "" : ",") + column;
  return Error{.message = "the header is not '" + expected + "'",
               .file = format.file,
               .line = lines.line(),
               .hint = "use these column names in this order"};
}

/// Checks the range of numbers of one quantity. The first of them is column `first` of `format`.
std::optional<RowFault> check_columns(const RowFormat& format, const InputRange& range,
                                      std::span<const double> numbers, std::size_t first) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::optional<Error> error = check_range(range, numbers[i]);
    if (!error) continue;
    error->place = format.columns[first + i];
    return RowFault(*std::move(error), "number out of range");
  }
  return std::nullopt;
}

/// Largest possible number of rows. Reserving them at once takes half the memory that growing does
/// for an hour of samples. The number is bounded by the shortest row, so that a file of empty lines
/// reserves no multiple of its size.
std::size_t max_rows(const SeriesText& text, const RowFormat& format) {
  const auto lines = std::count(text.text.begin(), text.text.end(), '\n') + 1;
  const std::size_t min_row_size = 2 * format.columns.size();
  return std::min(static_cast<std::size_t>(lines), text.text.size() / min_row_size + 1);
}

/// Rows of `x y z qx qy qz qw`.
Expected<Series<Trajectory>> read_poses(const SeriesText& text, const RowFormat& format,
                                        LineReader& lines) {
  std::vector<TimedPose> poses;
  poses.reserve(max_rows(text, format));
  const auto handle = [&](Stamp stamp, std::span<const double> n) -> std::optional<RowFault> {
    if (auto fault = check_columns(format, ranges::kCoordinate, n.first(3), 1)) return fault;
    if (std::optional<Error> error = check_unit_quaternion(n.subspan(3))) {
      return RowFault(*std::move(error), "no unit quaternion");
    }
    poses.push_back({stamp, Pose(Eigen::Quaterniond(n[6], n[3], n[4], n[5]), {n[0], n[1], n[2]})});
    return std::nullopt;
  };
  Expected<RowReport> report = read_number_rows(format, lines, handle);
  if (!report) return report.error();
  return Series<Trajectory>{Trajectory(std::move(poses)), *std::move(report)};
}

}  // namespace

std::optional<Error> check_unit_quaternion(std::span<const double> xyzw) {
  const double norm = Eigen::Vector4d(xyzw[0], xyzw[1], xyzw[2], xyzw[3]).norm();
  // A unit quaternion written with few digits has an error of about 1e-3; beyond a tenth it is
  // something else, such as columns in another order.
  if (std::abs(norm - 1.0) <= 0.1) return std::nullopt;
  return Error{.message = "the quaternion has the norm " + std::to_string(norm) + ", not 1",
               .hint = "write a unit quaternion in the order qx qy qz qw"};
}

Expected<std::filesystem::path> path_inside_folder(std::string_view text) {
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  const bool has_nul = text.find('\0') != text.npos;
  if (path.empty() || path == "." || path.is_absolute() || *path.begin() == ".." || has_nul) {
    return Error{.message = "'" + std::string(text) + "' does not lie in the recording's folder",
                 .hint = "give a path relative to the folder, without leaving it"};
  }
  return path;
}

Expected<Series<std::vector<ListedImage>>> parse_image_list(const SeriesText& text) {
  Series<std::vector<ListedImage>> list;
  LineReader lines(text.text);
  const auto handle = [&](Stamp stamp,
                          std::span<const std::string_view> fields) -> std::optional<RowFault> {
    const Expected<std::filesystem::path> path = path_inside_folder(fields[0]);
    if (!path) return RowFault(path.error(), "path that leaves the folder");
    list.content.push_back({stamp, *path, lines.line()});
    return std::nullopt;
  };
  Expected<RowReport> report =
      read_rows(format_of(text, Separator::whitespace,
                          {"timestamp", "path (in \"...\" where it has spaces)"}),
                lines, handle);
  if (!report) return report.error();
  list.report = *std::move(report);
  return list;
}

Expected<Series<Trajectory>> parse_trajectory(const SeriesText& text) {
  LineReader lines(text.text);
  const RowFormat format =
      format_of(text, Separator::whitespace, {"t", "tx", "ty", "tz", "qx", "qy", "qz", "qw"});
  return read_poses(text, format, lines);
}

Expected<Series<Trajectory>> parse_tool(const SeriesText& text) {
  LineReader lines(text.text);
  const RowFormat format =
      format_of(text, Separator::comma, {"t", "x", "y", "z", "qx", "qy", "qz", "qw"});
  if (const Expected<void> header = expect_header(format, lines); !header) return header.error();
  return read_poses(text, format, lines);
}

Expected<Series<std::vector<WrenchSample>>> parse_wrench(const SeriesText& text) {
  LineReader lines(text.text);
  const RowFormat format =
      format_of(text, Separator::comma, {"t", "fx", "fy", "fz", "tx", "ty", "tz"});
  if (const Expected<void> header = expect_header(format, lines); !header) return header.error();
  Series<std::vector<WrenchSample>> wrench;
  wrench.content.reserve(max_rows(text, format));
  const auto handle = [&](Stamp stamp, std::span<const double> n) -> std::optional<RowFault> {
    if (auto fault = check_columns(format, ranges::kForce, n.first(3), 1)) return fault;
    if (auto fault = check_columns(format, ranges::kTorque, n.subspan(3), 4)) return fault;
    wrench.content.push_back({stamp, {n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
    return std::nullopt;
  };
  Expected<RowReport> report = read_number_rows(format, lines, handle);
  if (!report) return report.error();
  wrench.report = *std::move(report);
  return wrench;
}

Expected<Series<std::vector<JointSample>>> parse_joints(const SeriesText& text) {
  const Expected<Series<JointLog>> log = parse_joint_log(text);
  if (!log) return log.error();
  Series<std::vector<JointSample>> joints{.content = {}, .report = log->report};
  const auto row_of = [](const Eigen::MatrixXd& values, std::size_t row) {
    if (values.rows() == 0) return std::vector<double>();
    const Eigen::VectorXd numbers = values.row(static_cast<Eigen::Index>(row)).transpose();
    return std::vector<double>(numbers.begin(), numbers.end());
  };
  for (std::size_t row = 0; row < log->content.t.size(); ++row) {
    joints.content.push_back({.stamp = log->content.stamps[row],
                              .position = row_of(log->content.position, row),
                              .velocity = row_of(log->content.velocity, row),
                              .torque = row_of(log->content.torque, row)});
  }
  return joints;
}

}  // namespace pcavr
