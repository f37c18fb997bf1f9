// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "parameter_history.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/parameter_title.hpp"

namespace pcavr {
namespace {

constexpr double kMinContactForce = 0.5;  // [N] mean: below, a relative error says nothing
constexpr std::size_t kMaxArrivalRows = 200;

const char* unit_of(const std::string& name) {
  static const std::map<std::string, const char*> units{
      {"contact.stiffness", "N/mⁿ"},     {"contact.damping", "N s/mⁿ⁺¹"},
      {"contact.exponent", "exponent"},  {"mass", "kg"},
      {"limiting_static_friction", "N"}, {"sliding_friction_coefficient", "coefficient"},
      {"viscous_friction", "N s/m"}};
  const auto known = units.find(name);
  return known == units.end() ? "SI" : known->second;
}

/// Mean error over mean force of the samples in [from, to); nothing without contact there.
std::optional<double> force_error(const std::vector<ForceSample>& forces, Stamp from, Stamp to) {
  const auto is_before = [](const ForceSample& sample, Stamp stamp) {
    return sample.stamp < stamp;
  };
  const auto begin = std::lower_bound(forces.begin(), forces.end(), from, is_before);
  const auto end = std::lower_bound(begin, forces.end(), to, is_before);
  double error = 0.0, force = 0.0, count = 0.0;
  for (auto sample = begin; sample != end; ++sample) {
    error += std::abs(sample->rendered - sample->measured);
    force += std::abs(sample->measured);
    count += 1.0;
  }
  if (count == 0.0 || force / count < kMinContactForce) return std::nullopt;
  return error / force;
}

bool has_changed(const std::vector<ParameterSample>& samples) {
  return std::any_of(samples.begin(), samples.end(), [&](const ParameterSample& sample) {
    return sample.running != samples.front().running ||
           sample.transmitted != samples.front().transmitted;
  });
}

/// Steps: a value lasts until the next row.
Plot history_plot(const std::string& name, const std::vector<ParameterSample>& samples, Stamp end,
                  Stamp origin) {
  Plot plot{.title = parameter_title(name) + ": running and transmitted [paper C, figure 9]",
            .x_label = "time (s)",
            .y_label = unit_of(name),
            .y_from_zero = true};
  PlotSeries running{.label = "running (robot's site)", .color = 1};
  PlotSeries transmitted{.label = "transmitted (operator's site)", .color = 0, .dashed = true};
  const auto add = [&](Stamp stamp, const ParameterSample& sample) {
    const double t = to_seconds(stamp - origin);
    running.x.push_back(t), running.y.push_back(sample.running);
    transmitted.x.push_back(t), transmitted.y.push_back(sample.transmitted);
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) add(samples[i].stamp, samples[i - 1]);
    add(samples[i].stamp, samples[i]);
  }
  add(std::max(end, samples.back().stamp), samples.back());
  plot.series = {std::move(running), std::move(transmitted)};
  return plot;
}

Plot error_plot(const std::vector<ForceSample>& forces,
                const std::vector<ParameterArrival>& arrivals, Stamp origin) {
  constexpr double kGap = 0.05;  // [s] without samples: out of contact
  Plot plot{.title = "Error of the rendered force",
            .x_label = "time (s)",
            .y_label = "error (N)",
            .pin_label = "parameters arrive",
            .y_from_zero = true};
  PlotSeries error{.label = "rendered less measured, magnitude", .color = 0};
  for (const ForceSample& sample : forces) {
    const double t = to_seconds(sample.stamp - origin);
    if (!error.x.empty() && t - error.x.back() > kGap) {
      error.x.push_back(t), error.y.push_back(kLineBreak);
    }
    error.x.push_back(t), error.y.push_back(std::abs(sample.rendered - sample.measured));
  }
  plot.series = {std::move(error)};
  for (const ParameterArrival& arrival : arrivals) {
    plot.pins.push_back({to_seconds(arrival.stamp - origin), false});
  }
  return plot;
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string percent_text(const std::optional<double>& ratio) {
  return ratio ? readable(kPercent * *ratio) : "no contact";
}

void add_arrivals(const std::vector<ParameterArrival>& arrivals, Stamp origin,
                  ReportSection& section) {
  ReportTable table{
      .title = "Each arrival of parameters",
      .columns = {"time (s)", "parameters", "force error until then (%)", "force error after (%)"},
      .note =
          "Mean error over mean force in contact, between one arrival and the "
          "next.",
      .is_folded = arrivals.size() > 20};
  for (std::size_t i = 0; i < std::min(arrivals.size(), kMaxArrivalRows); ++i) {
    const ParameterArrival& arrival = arrivals[i];
    table.rows.push_back(
        {fixed(to_seconds(arrival.stamp - origin), 2), joined_names(arrival.parameters),
         percent_text(arrival.force_error_before), percent_text(arrival.force_error_after)});
    const std::string key = section.key + ".arrival." + std::to_string(i + 1) + ".";
    section.values.push_back({key + "t_s", arrival.stamp.seconds()});
    section.values.push_back({key + "parameters", joined_names(arrival.parameters)});
    if (arrival.force_error_before) {
      section.values.push_back({key + "force_error_before", *arrival.force_error_before});
    }
    if (arrival.force_error_after) {
      section.values.push_back({key + "force_error_after", *arrival.force_error_after});
    }
  }
  section.tables.push_back(std::move(table));
}

}  // namespace

std::vector<ParameterArrival> parameter_arrivals(const ParameterSamples& history,
                                                 const std::vector<ForceSample>& forces) {
  std::map<Stamp, std::vector<std::string>> changes;
  for (const auto& [name, samples] : history) {
    for (std::size_t i = 1; i < samples.size(); ++i) {
      if (samples[i].transmitted != samples[i - 1].transmitted) {
        changes[samples[i].stamp].push_back(name);
      }
    }
  }
  std::vector<ParameterArrival> arrivals;
  for (auto& [stamp, names] : changes) arrivals.push_back({stamp, std::move(names)});
  const Stamp begin = forces.empty() ? Stamp{} : forces.front().stamp;
  // The end is beyond the last sample.
  const Stamp end = forces.empty() ? Stamp{} : forces.back().stamp + std::chrono::milliseconds(1);
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    arrivals[i].force_error_before =
        force_error(forces, i > 0 ? arrivals[i - 1].stamp : begin, arrivals[i].stamp);
    arrivals[i].force_error_after = force_error(
        forces, arrivals[i].stamp, i + 1 < arrivals.size() ? arrivals[i + 1].stamp : end);
  }
  return arrivals;
}

ReportSection parameter_history_section(const std::string& object, const Findings& findings) {
  const RunFindings& run = *findings.run;
  const ParameterSamples& history = run.files.parameter_history.at(object);
  ReportSection section{
      .title = object + ": parameters at both sites", .key = "history." + object, .is_brief = true};
  const auto forces = run.files.forces.find(object);
  const std::vector<ForceSample> none;
  const std::vector<ForceSample>& samples =
      forces == run.files.forces.end() ? none : forces->second;
  Stamp end = findings.origin;
  if (!samples.empty()) end = samples.back().stamp;
  for (const auto& [name, rows] : history) end = std::max(end, rows.back().stamp);
  for (const auto& [name, rows] : history) {
    if (has_changed(rows)) {
      section.plots.push_back(history_plot(name, rows, end, findings.origin));
    }
  }
  if (section.plots.empty()) return section;
  const std::vector<ParameterArrival> arrivals = parameter_arrivals(history, samples);
  if (!samples.empty()) section.plots.push_back(error_plot(samples, arrivals, findings.origin));
  add_arrivals(arrivals, findings.origin, section);
  return section;
}

}  // namespace pcavr
