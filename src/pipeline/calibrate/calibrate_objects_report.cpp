// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/geometry/convex_hull.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate_objects.hpp"

#include "calibration_report.hpp"

namespace pcavr {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// The body's outline from above, and where the tip's centre was, in the tracker's frame.
Plot contact_map(const CalibratedObject& found, const TouchedObject& object) {
  Plot plot{.title = "From above, in the tracker's frame",
            .x_label = "(m)",
            .y_label = "(m)",
            .equal_axes = true};
  const Eigen::Quaterniond q_level_tracked =
      Eigen::Quaterniond::FromTwoVectors(object.up_tracked, Eigen::Vector3d::UnitZ());
  const auto outline = [&](const Pose& T_tracked_object, double scale, PlotSeries series) {
    std::vector<Eigen::Vector3d> corners;
    for (const Eigen::Vector3f& vertex : object.model.mesh_object.vertices) {
      const Eigen::Vector3d p = scale * vertex.cast<double>();
      corners.push_back(q_level_tracked * (T_tracked_object * p));
    }
    const std::vector<Eigen::Vector3d> hull = convex_hull_xy(std::move(corners));
    for (std::size_t i = 0; i <= hull.size() && !hull.empty(); ++i) {
      series.x.push_back(hull[i % hull.size()].x());
      series.y.push_back(hull[i % hull.size()].y());
    }
    plot.series.push_back(std::move(series));
  };
  outline(object.T_tracked_object, 1.0, {.label = "mesh as stated", .color = 1, .dashed = true});
  outline(found.T_tracked_object, found.scale, {.label = "mesh", .color = 0});
  PlotSeries tip{.label = "tip's centre in contact", .color = 2, .points = true};
  for (const ContactPoint& point : object.points) {
    const Eigen::Vector3d p = q_level_tracked * point.p_tracked;
    tip.x.push_back(p.x());
    tip.y.push_back(p.y());
  }
  plot.series.push_back(std::move(tip));
  return plot;
}

ReportTable parameter_table(const CalibratedObject& found) {
  ReportTable table{.title = "Pose of the mesh in the tracker's frame",
                    .columns = {"along, about", "position (mm)", "± std (mm)",
                                "rotation vector (deg)", "± std (deg)"},
                    .note = "Stds in the mesh's axes. Not observable: as stated."};
  const Vector6d twist = found.T_tracked_object.log();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const auto std_text = [&](std::size_t parameter, double unit) {
      return found.is_observable[parameter] ? readable(unit * found.stds[parameter])
                                            : "not observable";
    };
    table.rows.push_back({std::string(1, "xyz"[i]),
                          fixed(1e3 * found.T_tracked_object.translation()[axis], 1),
                          std_text(i, 1e3), fixed(kDegreesPerRadian * twist[3 + axis], 2),
                          std_text(3 + i, kDegreesPerRadian)});
  }
  return table;
}

ReportTable objects_headline(const std::vector<CalibratedObject>& found) {
  ReportTable table{.title = "Tip to surface", .columns = {"metric", "value", "unit"}};
  for (const CalibratedObject& object : found) {
    table.rows.push_back({object.name + ": each contact by the others, rms",
                          readable(1e3 * object.held_out_rms), "mm"});
    table.rows.push_back(
        {object.name + ": as stated, rms", readable(1e3 * object.before_rms), "mm"});
  }
  return table;
}

}  // namespace

Expected<void> write_objects_report(const std::vector<CalibratedObject>& found,
                                    const std::vector<TouchedObject>& objects,
                                    const std::string& report_json,
                                    const std::filesystem::path& folder) {
  ReportPage page{.title = "Tracked objects", .heading = "Tracked objects"};
  page.headline = objects_headline(found);
  for (std::size_t i = 0; i < found.size(); ++i) {
    page.notes.insert(page.notes.end(), found[i].notes.begin(), found[i].notes.end());
    page.verdict += (i == 0 ? "" : " ") + describe_object(found[i]) + '.';
    PageSection section{.title = found[i].name};
    section.blocks.emplace_back(std::vector<ReportTable>{parameter_table(found[i])});
    section.blocks.emplace_back(PlotGroup{"", {contact_map(found[i], objects[i])}});
    page.sections.push_back(std::move(section));
  }
  return write_calibration_report(std::move(page),
                                  "Std: standard deviation by the scatter between contacts.",
                                  report_json, folder);
}

}  // namespace pcavr
