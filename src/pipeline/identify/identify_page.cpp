// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_page.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/report/number_text.hpp"
#include "pcavr/base/report/parameter_title.hpp"

#include "identify_plots.hpp"

namespace pcavr {
namespace {

constexpr double kMilliseconds = 1e3;

std::string text_of(const IdentifiedParameter& parameter) {
  const UncertainText text = uncertain(parameter.value, parameter.std);
  return text.value + " ± " + text.std;
}

bool is_known(const ParameterFinding& row) { return row.is_excited || row.value != 0.0; }

UncertainText text_of(const ParameterFinding& row) {
  if (!is_known(row)) return {};
  return uncertain(row.value, row.std);
}

ReportTable findings_table(const ObjectIdentification& object) {
  ReportTable table{.title = "Values",
                    .columns = {"parameter", "value", "± std", "unit", "identified",
                                "source, or the motion that would identify it"}};
  for (const ParameterFinding& row : object.findings) {
    const UncertainText text = text_of(row);
    table.rows.push_back({parameter_title(row.name), text.value, text.std, row.unit,
                          row.is_excited ? "yes" : "no", row.remark});
  }
  return table;
}

ReportTable comparison_table(const ObjectIdentification& object) {
  ReportTable table{
      .title = "Estimators on the presses",
      .columns = {"method", "until the first press's peak is predicted within 10 % (ms)",
                  "steady error (%)", "mean force error, tip stationary (%)"}};
  for (const EstimatorTrace& trace : object.comparison) {
    table.rows.push_back(
        {name_of(trace.method),
         trace.settling ? fixed(*trace.settling * kMilliseconds, 0) : "never",
         readable(trace.steady_error * kPercent),
         trace.mean_force_error ? readable(*trace.mean_force_error * kPercent) : "-"});
  }
  return table;
}

ReportTable faces_table(const ObjectIdentification& object) {
  ReportTable table{.title = "Faces, from pushes before breakaway",
                    .columns = {"normal in the object's axes", "pushes", "stiffness k (N/m^n)",
                                "damping λ (N s/m^(n+1))", "exponent n"}};
  for (const FaceContact& face : object.faces) {
    const ContactFit& fit = face.contact.best();
    const Eigen::Vector3d& n = face.normal_object;
    const bool has_damping = fit.damping.is_excited && fit.damping.value > 0.0;
    table.rows.push_back({fixed(n.x(), 2) + " " + fixed(n.y(), 2) + " " + fixed(n.z(), 2),
                          std::to_string(face.pushes), fit.is_valid ? text_of(fit.stiffness) : "-",
                          !fit.is_valid ? "-"
                          : has_damping ? text_of(fit.damping)
                                        : "not identified",
                          fit.is_valid ? fixed(fit.exponent.value, 2) + ", given" : "-"});
  }
  return table;
}

/// Pushes whose line a press checks.
ReportTable press_lines_table(const Identification& found, std::size_t object) {
  ReportTable table{
      .title = "Pushes beside the press's law [paper C, figure 5]",
      .columns = {"breakaway at (s)", "force at its peak (N)", "stiffness, push over press",
                  "force where it leaves the press's line (N)"}};
  for (const Contact& contact : found.contacts) {
    if (contact.object != object || !contact.press_line) continue;
    const PressLine& line = *contact.press_line;
    if (!line.ratio.is_excited) continue;
    table.rows.push_back({fixed(contact.breakaway.t, 2), readable(contact.breakaway.force),
                          text_of(line.ratio),
                          line.t_mutation ? readable(line.force) : "does not leave it"});
  }
  return table;
}

ReportTable impacts_table(const ObjectIdentification& object) {
  ReportTable table{.title = "Impacts",
                    .columns = {"time (s)", "duration (ms)", "approach (mm/s)", "restitution c",
                                "published law with the smallest error",
                                "damping over stiffness, exact (s/m)", "tool's mass (kg)"}};
  for (const MeasuredImpact& impact : object.impacts) {
    const double approach = impact.approach_speed.value * 1e3;
    table.rows.push_back({fixed(impact.t, 2), fixed(impact.duration * kMilliseconds, 0),
                          fixed(approach, 0), text_of(impact.restitution),
                          std::string(name_of(impact.law)), text_of(impact.damping_over_stiffness),
                          text_of(impact.mass)});
  }
  return table;
}

/// A section of the tables that have rows and of plots; nothing without either.
void add_section(const std::string& title, std::vector<ReportTable> tables, std::vector<Plot> plots,
                 std::vector<PageSection>& sections) {
  std::erase_if(tables, [](const ReportTable& table) { return table.rows.empty(); });
  if (tables.empty() && plots.empty()) return;
  PageSection& section = sections.emplace_back(PageSection{.title = title});
  if (!tables.empty()) section.blocks.emplace_back(std::move(tables));
  if (!plots.empty()) section.blocks.emplace_back(PlotGroup{"", std::move(plots)});
}

PageSection parameters_section(const ObjectIdentification& object) {
  PageSection section{.title = object.name + ": parameters"};
  for (const std::string& text : object.notes) section.blocks.emplace_back(PageText{text, true});
  section.blocks.emplace_back(std::vector{findings_table(object)});
  return section;
}

void add_object(const Identification& found, std::size_t index,
                std::vector<PageSection>& sections) {
  const ObjectIdentification& object = found.objects[index];
  sections.push_back(parameters_section(object));
  std::vector<Plot> contact = contact_plots(object);
  if (!object.impacts.empty()) contact.push_back(damping_laws_plot(object));
  add_section(object.name + ": contact", {comparison_table(object), impacts_table(object)},
              std::move(contact), sections);
  if (found.goal != IdentificationGoal::friction) {
    add_section(object.name + ": faces", {faces_table(object)}, {}, sections);
    return;
  }
  std::vector<Plot> pushes = push_plots(found, index);
  if (const auto lines = force_lines(found, index)) {
    pushes.insert(pushes.begin(), force_lines_plot(*lines));
  }
  add_section(
      object.name + ": pushes until it slides",
      {faces_table(object), press_lines_table(found, index), critical_band_table(found, index)},
      std::move(pushes), sections);
  std::vector<Plot> slides = sliding_plots(object);
  std::ranges::copy(surface_plots(object), std::back_inserter(slides));
  add_section(object.name + ": sliding and turning", {}, std::move(slides), sections);
}

std::string offset_text(const TimeOffset& offset) {
  if (!offset.is_known) return "not known: this recording does not identify it";
  return fixed(offset.offset * kMilliseconds, 2) + " ± " + fixed(offset.std * kMilliseconds, 2) +
         " ms";
}

/// A parameter within a sentence.
std::string name_in_text(const ParameterFinding& row) {
  std::string name = parameter_title(row.name);
  name.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(name.front())));
  return name;
}

/// "; NAMES: a, b" of the rows that `keep` wants; empty without any.
template <typename Keep>
std::string listed(const std::string& names, const std::vector<ParameterFinding>& rows, Keep keep) {
  std::string text;
  for (const ParameterFinding& row : rows) {
    if (!keep(row)) continue;
    text += (text.empty() ? "; " + names + ": " : ", ") + name_in_text(row);
  }
  return text;
}

/// States how much was identified, by object, and what was not.
std::string verdict_of(const Identification& found) {
  std::string text;
  for (const ObjectIdentification& object : found.objects) {
    const std::vector<ParameterFinding>& rows = object.findings;
    const auto identified =
        std::ranges::count_if(rows, [](const ParameterFinding& row) { return row.is_excited; });
    text += fmt::format("{}{}: {} of {} parameters identified", text.empty() ? "" : " ",
                        object.name, identified, rows.size());
    text += listed("given", rows, [](const auto& row) { return !row.is_excited && is_known(row); });
    text += listed("not identified", rows, [](const auto& row) { return !is_known(row); }) + ".";
  }
  return text;
}

/// The five that matter first, in their order.
const std::vector<std::string>& main_parameters(IdentificationGoal goal) {
  static const std::vector<std::string> friction = {
      "limiting_static_friction", "sliding_friction_coefficient", "viscous_friction", "mass",
      "contact.stiffness"};
  static const std::vector<std::string> contact = {
      "contact.stiffness", "contact.damping", "contact.exponent", "restitution", "contact.mass"};
  return goal == IdentificationGoal::friction ? friction : contact;
}

/// A row for each parameter, a column for each object.
ReportTable headline_table(const Identification& found) {
  ReportTable table{.title = "Parameters", .columns = {"parameter", "unit"}};
  for (const ObjectIdentification& object : found.objects) table.columns.push_back(object.name);
  for (const std::string& name : main_parameters(found.goal)) {
    std::vector<std::string> row{parameter_title(name), ""};
    bool is_any_known = false;
    for (const ObjectIdentification& object : found.objects) {
      const auto one = std::ranges::find(object.findings, name, &ParameterFinding::name);
      const bool has_value = one != object.findings.end() && is_known(*one);
      row.push_back("-");
      if (!has_value) continue;
      is_any_known = true;
      const UncertainText text = text_of(*one);
      row[1] = one->unit;
      row.back() =
          text.value + (one->std ? " ± " + text.std : "") + (one->is_excited ? "" : ", given");
    }
    if (is_any_known) table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

ReportPage identification_page(const Identification& found, const std::string& recording) {
  ReportPage page{.title = "Identification: " + recording,
                  .heading = found.goal == IdentificationGoal::contact
                                 ? "Identification of contact"
                                 : "Identification of contact and friction"};
  page.inputs = {{{"recording "}, {recording, true}},
                 {{"force after tool: "},
                  {offset_text(found.inputs.tool_to_force), true},
                  {found.inputs.is_force_offset_applied ? ", removed" : ""}},
                 {{"tracking after tool: "}, {offset_text(found.inputs.tool_to_camera), true}},
                 {{"force noise "},
                  {readable(found.inputs.force_noise) + " N", true},
                  {", bias up to "},
                  {readable(found.inputs.max_drift) + " N", true},
                  {", "},
                  {std::to_string(found.inputs.force_spikes), true},
                  {" spikes removed"}}};
  page.verdict = verdict_of(found);
  page.notes = found.notes;
  page.headline = headline_table(found);
  for (std::size_t i = 0; i < found.objects.size(); ++i) add_object(found, i, page.sections);
  page.footer =
      "F = k dⁿ + λ dⁿ ḋ (n = 1: λ ḋ). Std: standard deviation of the value. "
      "Friction and mass: of their posterior, with the scatter between pushes; contact law: for "
      "independent noise, without errors of the model. The same figures in SI units, by the names "
      "of the parameter file, are in report.json. pcavr " +
      std::string(PCAVR_VERSION);
  return page;
}

}  // namespace pcavr
