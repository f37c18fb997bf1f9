// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate.hpp"

#include "calibration_report.hpp"
#include "pipeline/calibrate/calibration_tables.hpp"

namespace pcavr {
namespace {

constexpr double kRadianDegrees = 180.0 / std::numbers::pi;
constexpr double kMillimetres = 1e3;

ReportTable pose_table(const std::string& title, const CalibratedPose& pose) {
  ReportTable table{.title = title, .columns = {"quantity", "value", "± std", "unit"}};
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    if (!pose.position_std[axis]) {
      table.rows.push_back({kAxes[axis], "not observable", "-", "mm"});
      continue;
    }
    const UncertainText text = uncertain(kMillimetres * pose.T_a_b.translation()[axis],
                                         kMillimetres * *pose.position_std[axis]);
    table.rows.push_back({kAxes[axis], text.value, text.std, "mm"});
  }
  const Eigen::Vector3d vector = kRadianDegrees * pose.T_a_b.log().tail<3>();
  for (int axis = 0; axis < 3; ++axis) {
    const UncertainText text = uncertain(vector[axis], kRadianDegrees * pose.rotation_std[axis]);
    table.rows.push_back(
        {std::string("rotation vector, ") + kAxes[axis], text.value, text.std, "deg"});
  }
  return table;
}

ReportTable view_table(const HandEyeResult& found) {
  ReportTable table{
      .title = "Residuals by view",
      .columns = {"view", "board's position (mm)", "rotation (deg)", "distance (m)", ""},
      .is_folded = true};
  for (const HandEyeResidual& residual : found.residuals) {
    std::string remark = residual.is_outlier ? "left out" : "";
    if (residual.partner) remark += "; fits the board of " + *residual.partner;
    table.rows.push_back({residual.view, readable(kMillimetres * residual.position.norm()),
                          readable(kRadianDegrees * residual.rotation.norm()),
                          readable(residual.distance), std::move(remark)});
  }
  return table;
}

/// Points by view; outliers in another colour.
Plot residual_plot(const HandEyeResult& found, bool is_rotation) {
  Plot plot{.title = is_rotation ? "Rotation of the board" : "Position of the board",
            .x_label = "view in the order of the input",
            .y_label = is_rotation ? "residual (deg)" : "residual (mm)",
            .y_from_zero = true};
  PlotSeries fitted{.label = "fitted", .color = 0, .points = true};
  PlotSeries left_out{.label = "left out", .color = 1, .points = true};
  for (std::size_t i = 0; i < found.residuals.size(); ++i) {
    const HandEyeResidual& residual = found.residuals[i];
    PlotSeries& series = residual.is_outlier ? left_out : fitted;
    series.x.push_back(static_cast<double>(i));
    series.y.push_back(is_rotation ? kRadianDegrees * residual.rotation.norm()
                                   : kMillimetres * residual.position.norm());
  }
  plot.series.push_back(std::move(fitted));
  if (!left_out.x.empty()) plot.series.push_back(std::move(left_out));
  return plot;
}

Plot distance_plot(const HandEyeResult& found) {
  Plot plot{.title = "By distance",
            .x_label = "board from the camera (m)",
            .y_label = "residual (mm)",
            .y_from_zero = true};
  PlotSeries fitted{.label = "fitted", .color = 0, .points = true};
  for (const HandEyeResidual& residual : found.residuals) {
    if (residual.is_outlier) continue;
    fitted.x.push_back(residual.distance);
    fitted.y.push_back(kMillimetres * residual.position.norm());
  }
  plot.series.push_back(std::move(fitted));
  return plot;
}

ReportTable headline(const HandEyeResult& found) {
  ReportTable table{.title = "Errors", .columns = {"metric", "value", "unit"}};
  const auto add = [&](const char* name, double value, const char* unit) {
    table.rows.push_back({name, readable(value), unit});
  };
  if (found.held_out_rms) {
    add("board's position in views that were not fitted, rms", kMillimetres * *found.held_out_rms,
        "mm");
  }
  add("each view by the others, rms", kMillimetres * found.leave_one_out_rms, "mm");
  add("fitted views, rms", kMillimetres * found.position_rms, "mm");
  add("fitted views, rotation rms", kRadianDegrees * found.rotation_rms, "deg");
  return table;
}

}  // namespace

ReportPage hand_eye_page(const HandEyeResult& found) {
  const bool is_on_arm = found.mount == CameraMount::arm;
  ReportPage page{.title = "Hand-eye calibration", .heading = "Hand-eye calibration"};
  page.notes = found.notes;
  page.verdict = describe_cause(found) + '.';
  page.headline = headline(found);
  PageSection section{.title = "Result"};
  section.blocks.emplace_back(std::vector<ReportTable>{
      pose_table(is_on_arm ? "Camera in the flange" : "Camera in the base", found.camera),
      pose_table(is_on_arm ? "Board in the base" : "Board in the flange", found.board)});
  section.blocks.emplace_back(
      PlotGroup{"Residuals by view",
                {residual_plot(found, false), residual_plot(found, true), distance_plot(found)}});
  section.blocks.emplace_back(std::vector<ReportTable>{view_table(found)});
  page.sections.push_back(std::move(section));
  return page;
}

Expected<void> write_hand_eye_report(const HandEyeResult& found, const PairedPoses& input,
                                     const std::string& report_json,
                                     const std::filesystem::path& folder) {
  ReportPage page = hand_eye_page(found);
  page.inputs = {{{"robot: "}, {input.formats[0], true}}, {{"camera: "}, {input.formats[1], true}}};
  page.notes.insert(page.notes.begin(), input.notes.begin(), input.notes.end());
  return write_calibration_report(std::move(page),
                                  "Std: standard deviation, by the noise that the residuals show.",
                                  report_json, folder);
}

Expected<void> write_clock_report(const ComparedClocks& found, const std::string& report_json,
                                  const std::filesystem::path& folder) {
  const ClockOffset& clock = found.clock;
  ReportPage page{.title = "Clocks of two streams", .heading = "Clocks of two streams"};
  page.inputs = {{{"a: "}, {found.a.name, true}, {", " + found.formats[0]}},
                 {{"b: "}, {found.b.name, true}, {", " + found.formats[1]}}};
  page.notes = found.notes;
  const UncertainText offset = uncertain(kMillimetres * clock.offset, kMillimetres * clock.std);
  page.verdict = fmt::format("Add {} ± {} ms to b's stamps.", offset.value, offset.std);
  page.headline = {.title = "Agreement", .columns = {"metric", "value", "unit"}};
  page.headline.rows = {{"motion of a that b's explains", readable(100.0 * clock.explained), "%"},
                        {"time in which both move", readable(clock.overlap), "s"}};
  Plot plot{.title = "What the common motion leaves",
            .x_label = "time of b (s)",
            .y_label = "difference of the velocities (rad/s or m/s)",
            .y_from_zero = true};
  plot.series = {{.label = "a less b", .color = 2, .x = clock.residual_t, .y = clock.residual}};
  PageSection section{.title = "Residuals"};
  section.blocks.emplace_back(PlotGroup{"", {std::move(plot)}});
  page.sections.push_back(std::move(section));
  return write_calibration_report(std::move(page),
                                  "Std: standard deviation, by the scatter of parts of the record.",
                                  report_json, folder);
}

}  // namespace pcavr
