// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_touch.hpp"

#include <array>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/recordings/recording/csv_dialect.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "calibration_report.hpp"
#include "yaml_text.hpp"

namespace pcavr {
namespace {

struct LengthColumn {
  std::size_t column = 0;
  double metres = 1.0;
};

std::optional<LengthColumn> length_column(const std::vector<std::string>& header,
                                          const std::string& name) {
  const std::optional<FoundColumn> found = find_column(header, {name});
  if (!found) return std::nullopt;
  if (found->unit == "mm") return LengthColumn{found->column, 1e-3};
  if (found->unit == "cm") return LengthColumn{found->column, 1e-2};
  if (found->unit.empty() || found->unit == "m") return LengthColumn{found->column, 1.0};
  return std::nullopt;
}

}  // namespace

Expected<std::vector<TouchedPoint>> read_touched_points(const std::filesystem::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  LineReader lines(*text);
  const std::string header(lines.next().value_or(""));
  const char separator = separator_of(header);
  const std::vector<std::string> names = split_fields(separator, header);
  constexpr std::array<const char*, 6> kColumns = {"x", "y", "z", "base_x", "base_y", "base_z"};
  std::array<LengthColumn, 6> columns;
  for (std::size_t i = 0; i < kColumns.size(); ++i) {
    const std::optional<LengthColumn> column = length_column(names, kColumns[i]);
    if (!column) {
      return Error{.message = fmt::format("has no column {}", kColumns[i]),
                   .file = file.string(),
                   .line = 1,
                   .hint = "name them x, y, z (in the world) and base_x, base_y, base_z (the tip)"};
    }
    columns[i] = *column;
  }
  std::vector<TouchedPoint> points;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty() || trimmed(*line).starts_with('#')) continue;
    const std::vector<std::string> fields = split_fields(separator, *line);
    TouchedPoint point{.name = fmt::format("point {}", points.size() + 1)};
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::size_t at = columns[i].column;
      const auto number = at < fields.size() ? parse_number(fields[at]) : std::nullopt;
      if (!number) {
        return Error{.message = fmt::format("has no number in column {}", kColumns[i]),
                     .file = file.string(),
                     .line = lines.line(),
                     .hint = "write one row for each point"};
      }
      Eigen::Vector3d& p = i < 3 ? point.p_world : point.p_base;
      p[static_cast<Eigen::Index>(i % 3)] = columns[i].metres * *number;
    }
    for (std::size_t i = 0; i < names.size() && i < fields.size(); ++i) {
      if (parse_column(names[i]).name == "name") point.name = fields[i];
    }
    points.push_back(std::move(point));
  }
  return points;
}

std::string format_touch(const TouchResult& found, const std::filesystem::path& file) {
  std::string text =
      "format: pcavr-calibration/1\nkind: touch\nsource: " + quoted(file.string()) + '\n';
  text += "T_base_world:\n  position: " + number_list(found.T_base_world.translation()) + "  # m\n";
  text += "  rotation: " + number_list(found.T_base_world.rotation().coeffs()) + "  # x y z w\n";
  text += "  rotation_std: " + number_list(found.rotation_std) + "  # rad, about the base's axes\n";
  text += "  covariance:  # of the twist [v (m); w (rad)] in the world's axes: T exp([v; w])\n";
  text += row_lists(found.covariance, "    ");
  text += "centre_world: " + number_list(found.centre_world) + "  # m, of the points\n";
  text += "position_std: " + number_list(found.position_std) + "  # m, of their centre in base\n";
  text += "rms: " + shortest_decimal(found.rms) + "  # m per axis\n";
  text += "scale: " + shortest_decimal(found.scale) + "  # lengths in base over lengths in world\n";
  return text + "scale_std: " + shortest_decimal(found.scale_std) + '\n';
}

Expected<void> write_touch_report(const TouchResult& found, const std::string& report_json,
                                  const std::filesystem::path& folder) {
  ReportPage page{.title = "Touched points", .heading = "Touched points"};
  page.notes = found.notes;
  const UncertainText scale = uncertain(found.scale, found.scale_std);
  page.verdict = fmt::format("A touch is good to {} mm per axis.", readable(1e3 * found.rms));
  page.headline = {.title = "Accuracy", .columns = {"metric", "value", "unit"}};
  page.headline.rows = {
      {"a touch, rms per axis", readable(1e3 * found.rms), "mm"},
      {"the points' centre, std per axis", readable(1e3 * found.position_std.x()), "mm"},
      {"the world's rotation, std about the worst axis",
       readable(180.0 / std::numbers::pi * found.rotation_std.maxCoeff()), "deg"},
      {"lengths in base over those in the world", scale.value + " ± " + scale.std, "1"}};
  ReportTable table{.title = "Points",
                    .columns = {"point", "x (mm)", "y (mm)", "z (mm)"},
                    .note = "Touched less placed, in base."};
  Plot plot{.title = "What each point is off by",
            .x_label = "point in the order of the input",
            .y_label = "touched less placed (mm)"};
  for (int axis = 0; axis < 3; ++axis) {
    plot.series.push_back({.label = std::string(1, "xyz"[axis]), .color = axis, .points = true});
  }
  for (std::size_t i = 0; i < found.residuals.size(); ++i) {
    const Eigen::Vector3d error = 1e3 * found.residuals[i].error_base;
    table.rows.push_back(
        {found.residuals[i].name, readable(error.x()), readable(error.y()), readable(error.z())});
    for (int axis = 0; axis < 3; ++axis) {
      PlotSeries& series = plot.series[static_cast<std::size_t>(axis)];
      series.x.push_back(static_cast<double>(i + 1));
      series.y.push_back(error[axis]);
    }
  }
  PageSection section{.title = "Result"};
  section.blocks.emplace_back(std::vector<ReportTable>{std::move(table)});
  section.blocks.emplace_back(PlotGroup{"", {std::move(plot)}});
  page.sections.push_back(std::move(section));
  return write_calibration_report(
      std::move(page), "Std: standard deviation, by the points' residuals.", report_json, folder);
}

}  // namespace pcavr
