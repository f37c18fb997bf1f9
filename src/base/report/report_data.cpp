// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/base64.hpp"
#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/report_command.hpp"
#include "pcavr/base/report/report_page.hpp"

#include "decimation.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

Json series_json(const PlotSeries& full, bool is_map) {
  const PlotSeries series = is_map || full.points ? full : decimated(full, kPlotColumns);
  Json json{{"label", series.label}, {"color", series.color}};
  if (series.dashed) json["dashed"] = true;
  if (series.points) json["points"] = true;
  json["x"] = rounded_to_range(series.x);
  json["y"] = rounded_to_range(series.y);
  return json;
}

template <typename Interval>
Json intervals_json(const std::vector<Interval>& intervals) {
  Json list = Json::array();
  for (const Interval& one : intervals) {
    list.push_back({{"from", one.from}, {"to", one.to}, {"kind", one.kind}});
  }
  return list;
}

/// Adds only the properties that differ from a plain chart.
void add_axes(const Plot& plot, Json& json) {
  if (plot.from_zero) json["from_zero"] = true;
  if (plot.y_from_zero) json["y_from_zero"] = true;
  if (plot.equal_axes) json["equal_axes"] = true;
  if (plot.x_from) json["x_from"] = *plot.x_from;
  if (plot.x_to > 0.0) json["x_to"] = plot.x_to;
  if (plot.y_to > 0.0) json["y_to"] = plot.y_to;
}

Json plot_json(const Plot& plot) {
  Json json{{"title", plot.title}, {"x_label", plot.x_label}, {"y_label", plot.y_label}};
  add_axes(plot, json);
  json["series"] = Json::array();
  for (const PlotSeries& series : plot.series) {
    json["series"].push_back(series_json(series, plot.equal_axes));
  }
  json["bands"] = intervals_json(plot.bands);
  json["band_labels"] = plot.band_labels;
  json["marks"] = Json::array();
  for (const PlotMark& mark : plot.marks) {
    json["marks"].push_back({{"x", mark.x}, {"label", mark.label}});
  }
  json["pins"] = Json::array();
  for (const PlotPin& pin : plot.pins) {
    json["pins"].push_back({{"x", pin.x}, {"hollow", pin.is_hollow}});
  }
  if (plot.strip) {
    json["strip"] = series_json(*plot.strip, false);
    json["strip_x_label"] = plot.strip_x_label;
  }
  json["pin_label"] = plot.pin_label;
  json["hollow_pin_label"] = plot.hollow_pin_label;
  return json;
}

Json table_json(const ReportTable& table) {
  return {{"title", table.title},
          {"columns", table.columns},
          {"rows", table.rows},
          {"note", table.note},
          {"folded", table.is_folded}};
}

Json block_json(const PageText& text) {
  return {{"kind", "text"}, {"text", text.text}, {"highlighted", text.is_highlighted}};
}

Json block_json(const PagePicture& picture) {
  return {{"kind", "picture"},
          {"title", picture.title},
          {"source", "data:image/jpeg;base64," + base64(picture.jpeg)},
          {"note", picture.note}};
}

Json block_json(const PlotGroup& group) {
  Json json{{"kind", "plots"}, {"title", group.title}, {"plots", Json::array()}};
  for (const Plot& plot : group.plots) json["plots"].push_back(plot_json(plot));
  return json;
}

Json block_json(const LaneChart& chart) {
  Json json{{"kind", "lanes"},
            {"title", chart.title},
            {"x_label", chart.x_label},
            {"kind_labels", chart.kind_labels},
            {"lanes", Json::array()}};
  for (const Lane& lane : chart.lanes) {
    json["lanes"].push_back({{"group", lane.group},
                             {"label", lane.label},
                             {"intervals", intervals_json(lane.intervals)}});
  }
  return json;
}

Json block_json(const std::vector<ReportTable>& tables) {
  Json json{{"kind", "tables"}, {"tables", Json::array()}};
  for (const ReportTable& table : tables) json["tables"].push_back(table_json(table));
  return json;
}

Json section_json(const PageSection& section) {
  Json json{{"title", section.title}, {"blocks", Json::array()}};
  for (const PageBlock& block : section.blocks) {
    json["blocks"].push_back(std::visit([](const auto& one) { return block_json(one); }, block));
  }
  return json;
}

Json lines_json(const std::vector<std::vector<PageSpan>>& lines) {
  Json list = Json::array();
  for (const std::vector<PageSpan>& line : lines) {
    Json spans = Json::array();
    for (const PageSpan& span : line) {
      spans.push_back({{"text", span.text}, {"strong", span.is_strong}});
    }
    list.push_back(std::move(spans));
  }
  return list;
}

/// Inside a script element no "<" may begin a tag or a comment; JSON has it in strings only.
std::string without_markup(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char character : json) {
    if (character == '<') {
      text += "\\u003c";
    } else {
      text += character;
    }
  }
  return text;
}

}  // namespace

std::string format_report_data(const ReportPage& page) {
  Json json{{"format", "pcavr-report-data/1"},
            {"title", page.title},
            {"heading", page.heading},
            {"inputs", lines_json(page.inputs)},
            {"notes", page.notes},
            {"verdict", page.verdict},
            {"headline", table_json(page.headline)},
            {"sections", Json::array()},
            {"footer", page.footer}};
  for (const PageSection& section : page.sections) {
    json["sections"].push_back(section_json(section));
  }
  if (!report_command().empty()) json["command"] = report_command();
  return without_markup(json_text(json));
}

}  // namespace pcavr
