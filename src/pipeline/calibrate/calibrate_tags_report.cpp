// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate_tags.hpp"

#include "calibration_report.hpp"

namespace pcavr {
namespace {

constexpr double kToDegreesOfTag = 180.0 / std::numbers::pi;
constexpr double kToMillimetres = 1e3;

std::string heading_of(const CalibratedBody& body) {
  return body.name.empty() ? "Tags of the base" : "Tags of " + body.name;
}

void add_outline(const Pose& T_body_tag, double size, PlotSeries& series) {
  const auto corners = tag_corners(size);
  for (std::size_t i = 0; i <= 4; ++i) {
    const Eigen::Vector3d p = T_body_tag * corners[i % 4];
    series.x.push_back(p.x());
    series.y.push_back(p.y());
  }
  series.x.push_back(kLineBreak);
  series.y.push_back(kLineBreak);
}

/// The tags from above, where they are said to be, and the walk.
Plot map_of(const CalibratedBody& body, const TagWalk& walk) {
  Plot plot{.title = "From above", .x_label = "x (m)", .y_label = "y (m)", .equal_axes = true};
  PlotSeries found{.label = "tags", .color = 0};
  PlotSeries stated{.label = "where they are said to be", .color = 1, .dashed = true};
  PlotSeries camera{.label = "camera", .color = 2, .points = true};
  for (const LaidOutTag& tag : body.layout.tags) {
    add_outline(tag.T_body_tag, tag.size, found);
    if (!tag.shift) continue;
    for (const MarkerEntry& marker : walk.known.markers) {
      if (marker.id == tag.id) add_outline(marker.T_parent_marker, marker.size, stated);
    }
  }
  for (const std::optional<Pose>& T_body_camera : body.layout.T_body_camera) {
    if (!T_body_camera) continue;
    camera.x.push_back(T_body_camera->translation().x());
    camera.y.push_back(T_body_camera->translation().y());
  }
  // An object's camera path is that of the object's motion, too: it shows nothing.
  if (body.name.empty()) plot.series.push_back(std::move(camera));
  if (!stated.x.empty()) plot.series.push_back(std::move(stated));
  plot.series.push_back(std::move(found));
  return plot;
}

Plot std_plot(const CalibratedBody& body) {
  Plot plot{.title = "How sure each tag is",
            .x_label = "tag's number",
            .y_label = "std of the position (mm)",
            .y_from_zero = true};
  PlotSeries position{.label = "position, worst direction", .color = 0, .points = true};
  for (const LaidOutTag& tag : body.layout.tags) {
    position.x.push_back(tag.id.id);
    position.y.push_back(kToMillimetres * tag.position_std());
  }
  plot.series.push_back(std::move(position));
  return plot;
}

std::string remark_of(const LaidOutTag& tag) {
  std::string text = tag.is_reference ? "reference" : "";
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  if (tag.move) add("moved during the walk");
  if (tag.shift && tag.shift->has_moved) add("not where it is said to be");
  return text;
}

ReportTable tag_table(const CalibratedBody& body) {
  ReportTable table{.title = heading_of(body),
                    .columns = {"tag", "x (mm)", "y (mm)", "z (mm)", "± std (mm)", "± std (deg)",
                                "from stated (mm)", "from stated (deg)", "images", "left out",
                                "residual (px)", ""}};
  for (const LaidOutTag& tag : body.layout.tags) {
    const Eigen::Vector3d p = kToMillimetres * tag.T_body_tag.translation();
    table.rows.push_back({tag.id.to_string(), fixed(p.x(), 1), fixed(p.y(), 1), fixed(p.z(), 1),
                          readable(kToMillimetres * tag.position_std()),
                          readable(kToDegreesOfTag * tag.rotation_std()),
                          tag.shift ? readable(kToMillimetres * tag.shift->offset) : "-",
                          tag.shift ? readable(kToDegreesOfTag * tag.shift->rotation) : "-",
                          std::to_string(tag.views), std::to_string(tag.rejected),
                          readable(tag.pixel_rms), remark_of(tag)});
  }
  return table;
}

ReportTable tags_headline(const CalibratedTags& found) {
  ReportTable table{.title = "Agreement", .columns = {"metric", "value", "unit"}};
  for (const CalibratedBody& body : found.bodies) {
    const std::string name = body.name.empty() ? "base" : body.name;
    double largest = 0.0;
    for (const LaidOutTag& tag : body.layout.tags) {
      largest = std::max(largest, kToMillimetres * tag.position_std());
    }
    table.rows.push_back({name + ": largest std of a position", readable(largest), "mm"});
    table.rows.push_back({name + ": residual of a corner", readable(body.layout.pixel_rms), "px"});
  }
  return table;
}

}  // namespace

Expected<void> write_tags_report(const CalibratedTags& found, const TagWalk& walk,
                                 const std::string& report_json,
                                 const std::filesystem::path& folder) {
  ReportPage page{.title = "Layout of tags", .heading = "Layout of tags"};
  page.inputs = {{{"known before: "}, {walk.known.format, true}},
                 {{"images: "}, {std::to_string(walk.frames.size()), true}}};
  page.notes = found.notes;
  page.verdict = describe_tags(found) + '.';
  page.headline = tags_headline(found);
  for (const CalibratedBody& body : found.bodies) {
    PageSection section{.title = heading_of(body)};
    section.blocks.emplace_back(std::vector<ReportTable>{tag_table(body)});
    section.blocks.emplace_back(PlotGroup{"", {map_of(body, walk), std_plot(body)}});
    page.sections.push_back(std::move(section));
  }
  return write_calibration_report(std::move(page),
                                  "Std: standard deviation in the worst direction, by the corners' "
                                  "residuals, against the frame that the reference tags define.",
                                  report_json, folder);
}

}  // namespace pcavr
