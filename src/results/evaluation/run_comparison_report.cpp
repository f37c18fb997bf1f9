// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/csv_field.hpp"
#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/results/evaluation/compare_runs.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kPlottedMetrics = 6;  // the headline's first are the main ones
constexpr std::size_t kColors = 4;          // of a report's palette

/// A metric with its values by setting, in the order of the runs.
struct MetricColumn {
  std::string name;
  std::string unit;
  std::vector<std::vector<std::pair<std::size_t, double>>> by_setting;  ///< run and value
};

std::vector<MetricColumn> columns_of(const RunComparison& comparison) {
  std::vector<MetricColumn> columns;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    for (const RunMetric& metric : comparison.runs[i].metrics) {
      auto column = std::ranges::find(columns, metric.name, &MetricColumn::name);
      if (column == columns.end()) {
        columns.push_back({metric.name, metric.unit, {}});
        column = std::prev(columns.end());
        column->by_setting.resize(comparison.settings.size());
      }
      column->by_setting[comparison.setting_of_run[i]].emplace_back(i, metric.value);
    }
  }
  return columns;
}

double median_of(const std::vector<std::pair<std::size_t, double>>& values) {
  std::vector<double> numbers;
  for (const auto& [run, value] : values) numbers.push_back(value);
  return median(numbers);
}

std::string metric_title(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : fmt::format("{} ({})", name, unit);
}

/// A metric without a unit counts: whole numbers, and medians of them.
std::string metric_text(double value, const std::string& unit) {
  const bool is_whole = unit.empty() && value == std::floor(value);
  return is_whole ? fixed(value, 0) : readable(value);
}

std::string format_evaluations(const RunComparison& comparison) {
  std::string text = "run,recording,setting,metric,unit,value\n";
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const EvaluatedRun& run = comparison.runs[i];
    const std::string begin = csv_field(run.run) + ',' + csv_field(run.recording) + ',' +
                              csv_field(comparison.settings[comparison.setting_of_run[i]]) + ',';
    for (const RunMetric& metric : run.metrics) {
      text += begin + csv_field(metric.name) + ',' + metric.unit + ',' +
              shortest_decimal(metric.value) + '\n';
    }
  }
  return text;
}

std::string format_paired(const RunComparison& comparison) {
  std::string text = "metric,unit,from,to,pairs,mean_difference,median_difference,p,p_holm\n";
  for (const PairedDifference& one : comparison.differences) {
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", csv_field(one.metric), one.unit,
                        csv_field(one.from), csv_field(one.to), one.pairs,
                        shortest_decimal(one.mean), shortest_decimal(one.median),
                        shortest_decimal(one.p), shortest_decimal(one.p_holm));
  }
  return text;
}

ReportTable medians_table(const RunComparison& comparison,
                          const std::vector<MetricColumn>& columns) {
  ReportTable table{.title = "Medians over the runs", .columns = {"metric"}};
  for (std::size_t setting = 0; setting < comparison.settings.size(); ++setting) {
    const auto count = std::ranges::count(comparison.setting_of_run, setting);
    table.columns.push_back(fmt::format("{}: {} runs", comparison.settings[setting], count));
  }
  for (const MetricColumn& column : columns) {
    std::vector<std::string> row{metric_title(column.name, column.unit)};
    for (const auto& values : column.by_setting)
      row.push_back(values.empty() ? "-" : metric_text(median_of(values), column.unit));
    table.rows.push_back(std::move(row));
  }
  return table;
}

ReportTable differences_table(const RunComparison& comparison) {
  ReportTable table{
      .title = "Differences by recording",
      .columns = {"metric", "from", "to", "pairs", "mean", "median", "p", "p by Holm"},
      .note =
          "p: two-sided sign-flip permutation test of the mean of the paired differences "
          "[Fisher 1935]; by Holm [1979]: for all metrics of two settings together."};
  for (const PairedDifference& one : comparison.differences) {
    table.rows.push_back({metric_title(one.metric, one.unit), one.from, one.to,
                          std::to_string(one.pairs), readable(one.mean), readable(one.median),
                          fmt::format("{:.2g}", one.p), fmt::format("{:.2g}", one.p_holm)});
  }
  return table;
}

ReportTable runs_table(const RunComparison& comparison, const std::vector<MetricColumn>& columns) {
  ReportTable table{.title = "Runs", .columns = {"run", "folder", "setting"}, .is_folded = true};
  for (const MetricColumn& column : columns)
    table.columns.push_back(metric_title(column.name, column.unit));
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const EvaluatedRun& run = comparison.runs[i];
    std::vector<std::string> row{std::to_string(i + 1), run.run,
                                 comparison.settings[comparison.setting_of_run[i]]};
    for (const MetricColumn& column : columns) {
      const auto metric = std::ranges::find(run.metrics, column.name, &RunMetric::name);
      row.push_back(metric == run.metrics.end() ? "-" : metric_text(metric->value, column.unit));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The metric of each run, a colour for each setting.
Plot metric_plot(const RunComparison& comparison, const MetricColumn& column) {
  Plot plot{.title = column.name,
            .x_label = "run",
            .y_label = column.unit.empty() ? "count" : column.unit,
            .y_from_zero = true};
  for (std::size_t setting = 0; setting < column.by_setting.size(); ++setting) {
    PlotSeries series{.label = comparison.settings[setting],
                      .color = static_cast<int>(setting % kColors),
                      .points = true};
    for (const auto& [run, value] : column.by_setting[setting]) {
      series.x.push_back(static_cast<double>(run) + 1.0);
      series.y.push_back(value);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

ReportPage page_of(const RunComparison& comparison) {
  const std::vector<MetricColumn> columns = columns_of(comparison);
  const std::string heading = fmt::format("Evaluation of {} runs", comparison.runs.size());
  ReportPage page{.title = heading, .heading = heading};
  page.headline = medians_table(comparison, columns);
  page.headline.title.clear();
  PageSection section{.title = "Runs"};
  PlotGroup plots;
  for (std::size_t i = 0; i < std::min(kPlottedMetrics, columns.size()); ++i)
    plots.plots.push_back(metric_plot(comparison, columns[i]));
  if (!plots.plots.empty()) section.blocks.emplace_back(std::move(plots));
  std::vector<ReportTable> tables;
  if (!comparison.differences.empty()) tables.push_back(differences_table(comparison));
  tables.push_back(runs_table(comparison, columns));
  section.blocks.emplace_back(std::move(tables));
  page.sections.push_back(std::move(section));
  page.footer = "The same figures are in evaluations.csv and paired.csv. pcavr " PCAVR_VERSION;
  return page;
}

/// The columns of a table in equal widths, for a terminal.
std::string text_of(const ReportTable& table) {
  std::vector<std::size_t> widths;
  for (const std::string& column : table.columns) widths.push_back(column.size());
  for (const std::vector<std::string>& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text += i == 0 ? fmt::format("  {:<{}}", cells[i], widths[i])
                     : fmt::format("  {:>{}}", cells[i], widths[i]);
    }
    return text + '\n';
  };
  std::string text = table.title + '\n' + line(table.columns);
  for (const std::vector<std::string>& row : table.rows) text += line(row);
  return text;
}

Json json_of(const RunComparison& comparison, std::size_t i) {
  const EvaluatedRun& run = comparison.runs[i];
  Json json{{"run", run.run},
            {"recording", run.recording},
            {"setting", comparison.settings[comparison.setting_of_run[i]]},
            {"headline", Json::array()}};
  for (const RunMetric& metric : run.metrics) {
    json["headline"].push_back(
        {{"name", metric.name}, {"value", metric.value}, {"unit", metric.unit}});
  }
  return json;
}

}  // namespace

std::string run_comparison_json(const RunComparison& comparison) {
  Json json{{"format", "pcavr-evaluated-runs/1"},
            {"version", PCAVR_VERSION},
            {"settings", comparison.settings},
            {"runs", Json::array()},
            {"differences", Json::array()}};
  for (std::size_t i = 0; i < comparison.runs.size(); ++i)
    json["runs"].push_back(json_of(comparison, i));
  for (const PairedDifference& one : comparison.differences) {
    json["differences"].push_back({{"metric", one.metric},
                                   {"unit", one.unit},
                                   {"from", one.from},
                                   {"to", one.to},
                                   {"pairs", one.pairs},
                                   {"mean", one.mean},
                                   {"median", one.median},
                                   {"p", one.p},
                                   {"p_holm", one.p_holm}});
  }
  if (!comparison.objects.empty()) json["objects"] = comparison.objects;
  return json_text(json, 2) + '\n';
}

Expected<void> write_run_comparison(const RunComparison& comparison,
                                    const std::filesystem::path& folder) {
  Expected<void> done = write_file(folder / "evaluations.csv", format_evaluations(comparison));
  if (done) done = write_file(folder / "paired.csv", format_paired(comparison));
  if (done) done = write_file(folder / "report.json", run_comparison_json(comparison));
  if (done) done = write_report_page(page_of(comparison), folder);
  return done;
}

std::string run_comparison_text(const RunComparison& comparison) {
  std::string text = text_of(medians_table(comparison, columns_of(comparison)));
  RunComparison changed = comparison;  // a metric that is the same in each pair needs no line
  std::erase_if(changed.differences,
                [](const PairedDifference& one) { return one.mean == 0.0 && one.median == 0.0; });
  if (!changed.differences.empty()) text += text_of(differences_table(changed));
  return text;
}

}  // namespace pcavr
