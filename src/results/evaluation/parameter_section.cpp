// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/parameter_title.hpp"

#include "run_report.hpp"

namespace pcavr {
namespace {

std::string number_text(const std::optional<double>& value, double scale = 1.0) {
  return value ? readable(scale * *value) : "-";
}

bool is_default(const Findings& findings, const ParameterError& error) {
  if (!findings.run) return false;
  const auto& assumed = findings.run->files.settings.assumed;
  const auto names = assumed.find(error.object);
  if (names == assumed.end()) return false;
  // A run writes contact_stiffness for the parameter file's contact: {stiffness}.
  std::string name = error.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return std::find(names->second.begin(), names->second.end(), name) != names->second.end();
}

void add_values(const ParameterError& error, ReportSection& section) {
  const std::string key = "parameters." + error.object + "." + error.name;
  const auto add = [&](const std::string& name, const std::optional<double>& value) {
    if (value) section.values.push_back({key + "." + name, *value});
  };
  if (error.estimate) {
    add("value", error.estimate->value);
    add("std", error.estimate->std);
  }
  if (error.is_given) section.values.push_back({key + ".source", std::string("given")});
  add("truth", error.truth);
  add("error_relative", error.relative);
  add("error_in_std", error.error_in_std);
}

}  // namespace

ReportSection parameter_section(const Findings& findings) {
  ReportSection section{.title = "Parameters", .key = "parameters"};
  ReportTable table{.title = findings.has_true_parameters ? "Identified and true" : "Identified",
                    .columns = {"parameter", "object", "unit", "value", "std"}};
  if (findings.has_true_parameters) {
    table.columns.insert(table.columns.end(), {"truth", "error (%)", "error (std)"});
  }
  bool has_default = false;
  for (const ParameterError& error : findings.parameters) {
    const bool uses_default = is_default(findings, error);
    has_default = has_default || uses_default;
    const char* source = uses_default ? " *" : error.is_given ? " (given)" : "";
    const UncertainText found = error.estimate
                                    ? uncertain(error.estimate->value, error.estimate->std)
                                    : UncertainText{.value = "unknown"};
    std::vector<std::string> row = {parameter_title(error.name) + source, error.object, error.unit,
                                    found.value, found.std};
    if (findings.has_true_parameters) {
      row.insert(row.end(),
                 {number_text(error.truth),
                  error.is_given ? std::string("-") : number_text(error.relative, kPercent),
                  number_text(error.error_in_std)});
    }
    table.rows.push_back(std::move(row));
    add_values(error, section);
  }
  table.note =
      "Contact: F = k dⁿ + λ dⁿ ḋ (n = 1: λ ḋ), with penetration d and "
      "exponent n; stiffness and damping of different exponents have different units and are not "
      "compared. Elastic force: that at the penetration where the true contact's "
      "force equals the limiting friction. Given: stated, not identified; it has no error.";
  if (has_default) table.note += " *: default value at the start of the run.";
  section.tables.push_back(std::move(table));
  return section;
}

std::vector<Metric> parameter_headline(const Findings& findings) {
  std::vector<Metric> headline;
  for (const ParameterError& error : findings.parameters) {
    const bool is_main = error.name == "mass" || error.name == "limiting_static_friction" ||
                         error.name == "sliding_friction_coefficient";
    if (!is_main || !error.relative || error.is_given) continue;
    std::string name = error.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    headline.push_back({error.object + ": error of the " + name, kPercent * *error.relative, "%"});
  }
  return headline;
}

}  // namespace pcavr
