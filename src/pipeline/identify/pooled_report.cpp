// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/csv_field.hpp"
#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/parameter_title.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/identify_runs.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

std::string value_text(const ParameterValue& value) {
  const UncertainText text = uncertain(value.value, value.std);
  return value.std ? text.value + " ± " + text.std : text.value;
}

std::string scatter_text(const PooledParameter& parameter) {
  if (parameter.runs.size() < 2) return "-";
  return parameter.scatter > 0.0 ? readable(parameter.scatter) : "none seen";
}

bool is_left_out(const PooledObject& object, std::size_t run) {
  return std::ranges::find(object.left_out, run) != object.left_out.end();
}

/// Each run's value with its std, and the pooled one: a forest plot, with the runs along x.
Plot forest_plot(const PooledParameter& parameter) {
  Plot plot{.title = parameter_title(parameter.name),
            .x_label = "run, by its start",
            .y_label = parameter.unit.empty() ? "value" : parameter.unit};
  PlotSeries values{.label = "each run alone", .color = 0, .points = true};
  PlotSeries bars{.label = "± std", .color = 0};
  PlotSeries pooled{.label = "all runs", .color = 1},
      band{.label = "± std of all", .color = 1, .dashed = true};
  const double std = parameter.pooled.std.value_or(0.0);
  for (const PooledParameter::Run& run : parameter.runs) {
    const double x = static_cast<double>(run.run) + 1.0;
    values.x.push_back(x);
    values.y.push_back(run.value.value);
    for (const double sign : {-1.0, 1.0}) {
      bars.x.push_back(x);
      bars.y.push_back(run.value.value + sign * run.value.std.value_or(0.0));
    }
    bars.x.push_back(x);
    bars.y.push_back(kLineBreak);
  }
  const double first = static_cast<double>(parameter.runs.front().run) + 0.5;
  const double last = static_cast<double>(parameter.runs.back().run) + 1.5;
  pooled.x = {first, last};
  pooled.y = {parameter.pooled.value, parameter.pooled.value};
  band.x = {first, last, last, first, last};
  band.y = {parameter.pooled.value - std, parameter.pooled.value - std, kLineBreak,
            parameter.pooled.value + std, parameter.pooled.value + std};
  plot.series = {std::move(values), std::move(bars), std::move(pooled), std::move(band)};
  return plot;
}

ReportTable pooled_table(const PooledObject& object) {
  ReportTable table{.title = "All runs together",
                    .columns = {"parameter", "value", "unit", "runs that show it alone",
                                "scatter from run to run"}};
  for (const PooledParameter& parameter : object.parameters) {
    table.rows.push_back({parameter_title(parameter.name), value_text(parameter.pooled),
                          parameter.unit, std::to_string(parameter.runs.size()),
                          scatter_text(parameter)});
  }
  return table;
}

ReportTable groups_table(const PooledObject& object, RunGrouping grouping) {
  ReportTable table{
      .title = grouping == RunGrouping::support ? "By support" : "By speed",
      .columns = {"group", "runs", "parameter", "value", "unit", "scatter from run to run"}};
  for (const PooledGroup& group : object.groups) {
    for (const PooledParameter& parameter : group.parameters) {
      table.rows.push_back({group.name, std::to_string(group.runs.size()),
                            parameter_title(parameter.name), value_text(parameter.pooled),
                            parameter.unit, scatter_text(parameter)});
    }
  }
  return table;
}

ReportTable runs_table(const PooledObject& object, const PooledIdentification& found) {
  ReportTable table{.title = "Each run alone", .columns = {"run", "recording"}, .is_folded = true};
  for (const PooledParameter& parameter : object.parameters)
    table.columns.push_back(parameter_title(parameter.name) +
                            (parameter.unit.empty() ? "" : " (" + parameter.unit + ")"));
  for (std::size_t run = 0; run < found.runs.size(); ++run) {
    std::vector<std::string> row{std::to_string(run + 1), found.runs[run]};
    bool has_any = is_left_out(object, run);
    if (has_any) row[1] += " (left out)";
    for (const PooledParameter& parameter : object.parameters) {
      const auto own = std::ranges::find(parameter.runs, run, &PooledParameter::Run::run);
      row.push_back(own == parameter.runs.end() ? "-" : value_text(own->value));
      has_any |= own != parameter.runs.end();
    }
    if (has_any) table.rows.push_back(std::move(row));
  }
  return table;
}

PageSection object_section(const PooledObject& object, const PooledIdentification& found) {
  PageSection section{.title = object.name};
  section.blocks.emplace_back(std::vector<ReportTable>{pooled_table(object)});
  PlotGroup forest{.title = "Each run and all together"};
  for (const PooledParameter& parameter : object.parameters) {
    if (parameter.runs.size() > 1) forest.plots.push_back(forest_plot(parameter));
  }
  if (!forest.plots.empty()) section.blocks.emplace_back(std::move(forest));
  if (!object.groups.empty())
    section.blocks.emplace_back(std::vector<ReportTable>{groups_table(object, found.grouping)});
  section.blocks.emplace_back(std::vector<ReportTable>{runs_table(object, found)});
  for (const std::string& note : object.found.notes) section.blocks.emplace_back(PageText{note});
  return section;
}

ReportPage page_of(const PooledIdentification& found) {
  ReportPage page{.title = fmt::format("Identification: {} runs", found.runs.size()),
                  .heading = fmt::format("Identification by {} runs together", found.runs.size())};
  page.notes = found.warnings;
  for (const PooledObject& object : found.objects) {
    page.verdict += fmt::format("{}{}: {} runs, {} left out.", page.verdict.empty() ? "" : " ",
                                object.name, object.runs.size(), object.left_out.size());
    page.sections.push_back(object_section(object, found));
  }
  if (!found.objects.empty()) page.headline = pooled_table(found.objects.front());
  page.footer =
      "Std: of the value, by the contacts of all runs, with the scatter of the runs' own effects "
      "[Paule and Mandel 1982]. A run is left out where its limiting friction or coefficient is "
      "more "
      "than 5 stds from those of the others. The same figures are in report.json and runs.csv. "
      "pcavr " +
      std::string(PCAVR_VERSION);
  return page;
}

Json json_of(const PooledObject& object, const PooledIdentification& found) {
  Json json{{"name", object.name}, {"runs", Json::array()}, {"left_out", Json::array()}};
  for (const std::size_t run : object.runs) json["runs"].push_back(found.runs[run]);
  for (const std::size_t run : object.left_out) json["left_out"].push_back(found.runs[run]);
  for (const PooledParameter& parameter : object.parameters) {
    Json& entry = json["parameters"][parameter.name];
    entry = {{"value", parameter.pooled.value},
             {"std", parameter.pooled.std.value_or(0.0)},
             {"unit", parameter.unit},
             {"scatter", parameter.scatter},
             {"runs", Json::array()}};
    for (const PooledParameter::Run& run : parameter.runs) {
      entry["runs"].push_back({{"recording", found.runs[run.run]},
                               {"value", run.value.value},
                               {"std", run.value.std.value_or(0.0)},
                               {"stds_from_others", run.stds_from_others}});
    }
  }
  if (object.found.surface.status == LimitSurfaceFitStatus::fitted) {
    const LimitSurface& surface = object.found.surface.surface;
    json["limit_surface"] = {{"force", surface.force},
                             {"length", surface.length},
                             {"coefficients", surface.coefficients}};
    if (object.surface_std) json["limit_surface"]["coefficients_std"] = *object.surface_std;
  }
  for (const PooledGroup& group : object.groups) {
    Json& entry = json["groups"].emplace_back(Json{{"name", group.name}, {"runs", Json::array()}});
    for (const std::size_t run : group.runs) entry["runs"].push_back(found.runs[run]);
    for (const PooledParameter& parameter : group.parameters) {
      entry["parameters"][parameter.name] = {{"value", parameter.pooled.value},
                                             {"std", parameter.pooled.std.value_or(0.0)},
                                             {"unit", parameter.unit},
                                             {"scatter", parameter.scatter}};
    }
  }
  json["notes"] = object.found.notes;
  return json;
}

std::string format_json(const PooledIdentification& found) {
  Json json{{"format", "pcavr-pooled-identification/1"},
            {"version", PCAVR_VERSION},
            {"units", "SI"},
            {"runs", found.runs}};
  for (const auto& [key, value] : found.configuration) json["configuration"][key] = value;
  json["objects"] = Json::array();
  for (const PooledObject& object : found.objects)
    json["objects"].push_back(json_of(object, found));
  json["warnings"] = found.warnings;
  return json_text(json, 2) + '\n';
}

std::string format_csv(const PooledIdentification& found) {
  std::string text = "object,parameter,unit,recording,value,std,stds_from_others\n";
  for (const PooledObject& object : found.objects) {
    for (const PooledParameter& parameter : object.parameters) {
      const std::string begin =
          csv_field(object.name) + ',' + parameter.name + ',' + parameter.unit + ',';
      for (const PooledParameter::Run& run : parameter.runs) {
        text += fmt::format("{}{},{},{},{:.3f}\n", begin, csv_field(found.runs[run.run]),
                            run.value.value, run.value.std.value_or(0.0), run.stds_from_others);
      }
      const std::string std = parameter.pooled.std ? fmt::format("{}", *parameter.pooled.std) : "";
      text += fmt::format("{}all,{},{},\n", begin, parameter.pooled.value, std);
    }
  }
  return text;
}

std::string format_groups(const PooledIdentification& found) {
  std::string text = "object,group,runs,parameter,unit,value,std,scatter\n";
  for (const PooledObject& object : found.objects) {
    for (const PooledGroup& group : object.groups) {
      for (const PooledParameter& parameter : group.parameters) {
        const std::string std =
            parameter.pooled.std ? fmt::format("{}", *parameter.pooled.std) : "";
        text += fmt::format("{},{},{},{},{},{},{},{}\n", csv_field(object.name),
                            csv_field(group.name), group.runs.size(), parameter.name,
                            parameter.unit, parameter.pooled.value, std, parameter.scatter);
      }
    }
  }
  return text;
}

std::string tex_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (std::string_view("_&%#$").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string format_tex(const PooledIdentification& found) {
  std::string text =
      "\\begin{tabular}{llrrlr}\nobject & parameter & value & std & unit & runs \\\\\n\\hline\n";
  for (const PooledObject& object : found.objects) {
    for (const PooledParameter& parameter : object.parameters) {
      const UncertainText value = uncertain(parameter.pooled.value, parameter.pooled.std);
      text += fmt::format("{} & {} & {} & {} & {} & {} \\\\\n", tex_text(object.name),
                          tex_text(parameter_title(parameter.name)), value.value, value.std,
                          tex_text(parameter.unit), parameter.runs.size());
    }
  }
  return text + "\\end{tabular}\n";
}

}  // namespace

Expected<void> write_pooled_report(const PooledIdentification& found,
                                   const std::filesystem::path& folder) {
  Expected<void> done = write_report_page(page_of(found), folder);
  if (done) done = write_file(folder / "report.json", format_json(found));
  if (done) done = write_file(folder / "runs.csv", format_csv(found));
  if (done) done = write_file(folder / "parameters.tex", format_tex(found));
  if (done && found.grouping != RunGrouping::object)
    done = write_file(folder / "groups.csv", format_groups(found));
  return done;
}

}  // namespace pcavr
