// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate_depth.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

#include "calibration_report.hpp"

namespace pcavr {
namespace {

constexpr double kInMillimetres = 1e3;
constexpr int kCellPixels = 24;  ///< side of a cell in the picture [px]
/// Share of the cells whose error the picture's colours reach.
constexpr double kColoredShare = 0.95;
constexpr Rgb8 kNoTag{246, 246, 246};

/// White at 0, to blue (depth too small) or orange (too large) at 1.
Rgb8 color_of(double error) {
  const double share = std::clamp(std::abs(error), 0.0, 1.0);
  const Rgb8 full = error < 0.0 ? Rgb8{0, 90, 181} : Rgb8{220, 95, 0};
  const auto mix = [&](std::uint8_t value) {
    return static_cast<std::uint8_t>(std::lround(255.0 + share * (value - 255.0)));
  };
  return {mix(full.r), mix(full.g), mix(full.b)};
}

/// [m] The error at which the colours are full.
double color_range(const DepthCalibration& found) {
  std::vector<double> sizes;
  for (const double error : found.cells) {
    if (!std::isnan(error)) sizes.push_back(std::abs(error));
  }
  if (sizes.empty()) return 1e-3;
  std::sort(sizes.begin(), sizes.end());
  const auto last = static_cast<double>(sizes.size() - 1);
  return std::max(1e-6, sizes[static_cast<std::size_t>(kColoredShare * last)]);
}

ColorImage error_picture(const DepthCalibration& found, double range) {
  ColorImage image(kDepthCellColumns * kCellPixels, kDepthCellRows * kCellPixels, kNoTag);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const int cell = y / kCellPixels * kDepthCellColumns + x / kCellPixels;
      const double error = found.cells[static_cast<std::size_t>(cell)];
      if (!std::isnan(error)) image(x, y) = color_of(error / range);
    }
  }
  return image;
}

Plot distance_plot(const DepthCalibration& found, const DepthViews& views) {
  Plot plot{.title = "Depth against tags",
            .x_label = "distance by the tags (m)",
            .y_label = "depth less that of the tags (mm)"};
  PlotSeries before{.label = "as read", .color = 1, .points = true};
  PlotSeries after{.label = "corrected", .color = 0, .points = true};
  for (const DepthView& view : views.views) {
    before.x.push_back(view.by_tags);
    before.y.push_back(kInMillimetres * (view.by_depth - view.by_tags));
    after.x.push_back(view.by_tags);
    after.y.push_back(kInMillimetres * (found.scale * view.by_depth + found.offset - view.by_tags));
  }
  plot.series = {std::move(before), std::move(after)};
  return plot;
}

Plot plane_plot(const DepthViews& views) {
  Plot plot{.title = "How flat a tag is by depth",
            .x_label = "distance by the tags (m)",
            .y_label = "pixels about their plane, rms (mm)",
            .y_from_zero = true};
  PlotSeries series{.label = "a tag in one image", .color = 0, .points = true};
  for (const DepthView& view : views.views) {
    series.x.push_back(view.by_tags);
    series.y.push_back(kInMillimetres * view.plane_rms);
  }
  plot.series.push_back(std::move(series));
  return plot;
}

ReportTable depth_headline(const DepthCalibration& found) {
  ReportTable table{.title = "Depth", .columns = {"metric", "value", "unit"}};
  const UncertainText scale = uncertain(found.scale, found.scale_std);
  const UncertainText offset =
      uncertain(kInMillimetres * found.offset, kInMillimetres * found.offset_std);
  table.rows = {
      {"true depth over measured", scale.value + " ± " + scale.std, "1"},
      {"to be added", found.has_offset ? offset.value + " ± " + offset.std : "not observable",
       "mm"},
      {"error of each place by the others, rms", readable(kInMillimetres * found.held_out_rms),
       "mm"},
      {"error as the depth was read, rms", readable(kInMillimetres * found.before_rms), "mm"},
      {"error of the fitted places, rms", readable(kInMillimetres * found.fitted_rms), "mm"},
      {"pixels of a tag about their plane, rms, median", readable(kInMillimetres * found.plane_rms),
       "mm"},
      {"plane of a tag by depth against by its corners, median",
       readable(180.0 / std::numbers::pi * found.plane_tilt), "deg"},
      {"nearest tag", readable(found.nearest), "m"},
      {"farthest tag", readable(found.farthest), "m"}};
  return table;
}

}  // namespace

Expected<void> write_depth_report(const DepthCalibration& found, const DepthViews& views,
                                  const std::string& report_json,
                                  const std::filesystem::path& folder) {
  ReportPage page{.title = "Depth camera", .heading = "Depth camera"};
  page.inputs = {{{"images: "}, {std::to_string(views.frames), true}},
                 {{"views of a tag: "}, {std::to_string(views.views.size()), true}},
                 {{"places: "}, {std::to_string(views.places), true}}};
  page.notes = found.notes;
  page.verdict = describe_depth(found) + '.';
  page.headline = depth_headline(found);
  PageSection section{.title = "Errors"};
  section.blocks.emplace_back(PlotGroup{"", {distance_plot(found, views), plane_plot(views)}});
  const double range = color_range(found);
  Expected<std::string> jpeg = encode_color(error_picture(found, range));
  if (!jpeg) return jpeg.error();
  section.blocks.emplace_back(PagePicture{
      "Where in the image an error is left", *std::move(jpeg),
      fmt::format("Blue: depth too small, orange: too large, full colour from {} mm on; grey: no "
                  "tag was there.",
                  readable(kInMillimetres * range))});
  page.sections.push_back(std::move(section));
  return write_calibration_report(
      std::move(page),
      "Std: standard deviation by the scatter between places (jackknife). The tags' sizes and the "
      "focal length are taken as right.",
      report_json, folder);
}

}  // namespace pcavr
