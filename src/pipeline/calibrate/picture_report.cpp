// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate_pictures.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

#include "calibration_report.hpp"
#include "pipeline/calibrate/calibration_tables.hpp"

namespace pcavr {
namespace {

constexpr double kPerRadian = 180.0 / std::numbers::pi;
constexpr int kPictureWidth = 960;  ///< [px] of the coverage picture
constexpr Rgb8 kPaper{250, 250, 250}, kEmpty{246, 214, 205}, kCellLine{205, 205, 205};
/// Blue, orange: as the page's palette, for views that are fitted, and left out.
constexpr Rgb8 kFittedDot{0, 90, 181}, kOutlierDot{220, 95, 0};

void draw_disc(ColorImage& image, double x, double y, int radius, Rgb8 color) {
  const auto middle_x = static_cast<int>(std::lround(x)),
             middle_y = static_cast<int>(std::lround(y));
  for (int row = -radius; row <= radius; ++row) {
    for (int column = -radius; column <= radius; ++column) {
      if (row * row + column * column > radius * radius) continue;
      if (image.contains(middle_x + column, middle_y + row)) {
        image(middle_x + column, middle_y + row) = color;
      }
    }
  }
}

/// The image's cells, those without points shaded, and all points.
ColorImage coverage_picture(const CameraCalibration& found, const BoardViews& views) {
  const double scale = static_cast<double>(kPictureWidth) / views.width;
  const int height = std::max(1, static_cast<int>(std::lround(scale * views.height)));
  ColorImage image(kPictureWidth, height, kPaper);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < kPictureWidth; ++x) {
      const int column = x * kCoverageColumns / kPictureWidth, row = y * kCoverageRows / height;
      const bool is_line = x > 0 && y > 0 &&
                           ((x - 1) * kCoverageColumns / kPictureWidth != column ||
                            (y - 1) * kCoverageRows / height != row);
      if (found.coverage[static_cast<std::size_t>(row * kCoverageColumns + column)] == 0) {
        image(x, y) = kEmpty;
      }
      if (is_line) image(x, y) = kCellLine;
    }
  }
  for (const BoardView& view : views.views) {
    const auto of_view = std::find_if(found.views.begin(), found.views.end(),
                                      [&](const auto& other) { return other.name == view.name; });
    const bool is_fitted = of_view != found.views.end() && !of_view->is_outlier;
    for (const Eigen::Vector2d& pixel : view.pixels) {
      draw_disc(image, scale * pixel.x(), scale * pixel.y(), 2,
                is_fitted ? kFittedDot : kOutlierDot);
    }
  }
  return image;
}

ReportTable camera_table(const CameraModel& camera, const std::vector<double>& stds) {
  ReportTable table{.title = "Camera", .columns = {"parameter", "value", "± std", "unit"}};
  const std::array<double, 4> values{camera.fx, camera.fy, camera.cx, camera.cy};
  constexpr std::array<const char*, 4> kNames{"fx", "fy", "cx", "cy"};
  const auto add = [&](const std::string& name, double value, double std, const char* unit) {
    const UncertainText text = uncertain(value, std);
    if (std > 0.0) table.rows.push_back({name, text.value, text.std, unit});
  };
  for (std::size_t i = 0; i < 4; ++i) add(kNames[i], values[i], stds[i], "px");
  const auto coefficients = camera.distortion.coefficients();
  std::string names(coefficient_names(camera.distortion.model()));
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    const std::size_t end = names.find(' ');
    add(names.substr(0, end), coefficients[i], stds[4 + i], "");
    names = end == std::string::npos ? "" : names.substr(end + 1);
  }
  return table;
}

Plot view_plot(const std::string& title, const std::string& y_label, std::vector<double> values) {
  Plot plot{.title = title,
            .x_label = "view in the order of the input",
            .y_label = y_label,
            .y_from_zero = true};
  PlotSeries series{.label = y_label, .color = 0, .y = std::move(values), .points = true};
  for (std::size_t i = 0; i < series.y.size(); ++i) series.x.push_back(static_cast<double>(i));
  plot.series.push_back(std::move(series));
  return plot;
}

ReportTable camera_headline(const CameraCalibration& found) {
  ReportTable table{.title = "Errors", .columns = {"metric", "value", "unit"}};
  if (found.held_out_rms) {
    table.rows.push_back(
        {"points of views that were not fitted, rms", readable(*found.held_out_rms), "px"});
  }
  table.rows.push_back({"points of fitted views, rms", readable(found.pixel_rms), "px"});
  table.rows.push_back({"std of a point by the camera, where it is largest in the image",
                        readable(found.pixel_std), "px"});
  table.rows.push_back({"cells of the image with points", readable(100.0 * found.covered), "%"});
  return table;
}

ReportTable picture_table(const PictureRig& found) {
  ReportTable table{.title = "Pictures",
                    .columns = {"view", "pixels, rms (px)", "points on the board (mm)",
                                "arm's position (mm)", "arm's rotation (deg)"},
                    .is_folded = true};
  for (const PictureResidual& view : found.views) {
    table.rows.push_back({view.view, readable(view.pixel_rms), readable(1e3 * view.board_mean),
                          readable(1e3 * view.arm_position),
                          readable(kPerRadian * view.arm_rotation)});
  }
  return table;
}

}  // namespace

Expected<void> write_camera_report(const CameraCalibration& found, const BoardViews& views,
                                   const Board& board, const std::string& report_json,
                                   const std::filesystem::path& folder) {
  ReportPage page{.title = "Camera calibration", .heading = "Camera calibration"};
  page.inputs = {{{fmt::format("{} pictures of {} x {} pixels of a ", views.views.size(),
                               views.width, views.height)},
                  {describe(board), true}}};
  page.notes = views.notes;
  page.notes.insert(page.notes.end(), found.notes.begin(), found.notes.end());
  page.verdict = found.missing
                     ? fmt::format(
                           "The view that is missing: {}; the largest std of a point falls "
                           "from {:.2g} to {:.2g} px.",
                           found.missing->text, found.missing->std_now, found.missing->std_expected)
                     : "No single view would improve the camera by a tenth.";
  page.headline = camera_headline(found);
  PageSection section{.title = "Result"};
  section.blocks.emplace_back(std::vector<ReportTable>{camera_table(found.camera, found.stds)});
  const Expected<std::string> jpeg = encode_color(coverage_picture(found, views));
  if (!jpeg) return jpeg.error();
  section.blocks.emplace_back(PagePicture{
      "Coverage of the image", *jpeg,
      "Each dot is a point of the board (orange: of a view that was left out). Shaded cells have "
      "none: there the lens follows from the model alone."});
  std::vector<double> rms, tilts;
  for (const CalibratedView& view : found.views) {
    rms.push_back(view.rms);
    tilts.push_back(kPerRadian * view.tilt);
  }
  section.blocks.emplace_back(
      PlotGroup{"Views",
                {view_plot("Residuals", "rms (px)", std::move(rms)),
                 view_plot("Tilt of the board", "tilt (deg)", std::move(tilts))}});
  page.sections.push_back(std::move(section));
  return write_calibration_report(
      std::move(page),
      "Std: standard deviation, by the pixels' noise or the views' scatter, the larger.",
      report_json, folder);
}

Expected<void> write_picture_rig_report(const PictureRig& found, const PairedPictures& input,
                                        const Board& board, const std::string& report_json,
                                        const std::filesystem::path& folder) {
  ReportPage page = hand_eye_page(found.hand_eye);
  page.inputs = {{{"robot: "}, {input.format, true}},
                 {{fmt::format("{} pictures of a ", input.views.size())}, {describe(board), true}}};
  page.notes.insert(page.notes.begin(), input.notes.begin(), input.notes.end());
  PageSection section{.title = "Pictures"};
  if (found.is_camera_estimated) {
    section.blocks.emplace_back(
        std::vector<ReportTable>{camera_table(found.camera, found.camera_stds)});
  }
  std::vector<double> board_errors, arm_errors;
  for (const PictureResidual& view : found.views) {
    board_errors.push_back(1e3 * view.board_mean);
    arm_errors.push_back(1e3 * view.arm_position);
  }
  section.blocks.emplace_back(PlotGroup{
      "",
      {view_plot("Points on the board, by the arm's poses", "mean (mm)", std::move(board_errors)),
       view_plot("Flange, from where the arm said", "distance (mm)", std::move(arm_errors))}});
  section.blocks.emplace_back(std::vector<ReportTable>{picture_table(found)});
  page.sections.push_back(std::move(section));
  return write_calibration_report(
      std::move(page),
      "Std: standard deviation, by the pixels' noise or the views' scatter, the larger.",
      report_json, folder);
}

}  // namespace pcavr
