// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "paper_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "pcavr/base/report/number_text.hpp"

#include "arm_contacts.hpp"
#include "pooled_errors.hpp"

namespace pcavr {
namespace {

/// The papers' published results. B: haptic augmented reality, contact of a robot's tool with
/// plastic. C: movable objects in a point-cloud augmented virtual environment.
struct Published {
  const char* source;
  const char* what;
  const char* value;
};
constexpr Published kLimitingFoam = {"C, position tracking",
                                     "limiting friction of the foam-faced box, and its std",
                                     "9.57 N, 0.861 N"};
constexpr Published kLimitingRubber = {"C, position tracking",
                                       "limiting friction of the rubber-faced box, and its std",
                                       "40.62 N, 2.346 N"};
constexpr Published kContactLaw = {"C, table 1", "contact law", "not in the source"};
constexpr Published kFriction = {"C, table 2", "sliding friction coefficient, viscous friction",
                                 "not in the source"};
constexpr Published kMass = {"C, table 2", "error of the mass", "about 5 %"};
constexpr Published kSlidingError = {"C, Fig. 10", "position error while sliding",
                                     "about 3 mm, without delay"};
constexpr Published kSystemError = {"C, Fig. 11", "position error while touched or moving",
                                    "mainly in the transitions, with 200 + 200 ms; its size is not "
                                    "in the source"};
constexpr Published kForceError = {"C, Fig. 9", "relative force error once parameters were sent",
                                   "below 10 %, without delay"};
constexpr Published kPeakError = {"B, table 3", "relative error of a press's peak force",
                                  "1.85 ± 0.85 %"};
constexpr Published kSoftError = {"B, table 4", "relative error of the peak force on a soft object",
                                  "2.24 % (GADM 2.75 %, HSMM 3.12 %)"};
constexpr Published kSlotting = {"B, hole slotting", "peak force: real, virtual, difference",
                                 "91.23 N, 93.27 N, 2.24 %"};

/// Text where this run has no value.
constexpr char kNoValue[] = "–";

std::string with_unit(double value, const char* unit) { return readable(value) + ' ' + unit; }

/// ", with 200 + 200 ms": the run's delays, forward and backward.
std::string delay_text(const RunSettings& settings) {
  if (!settings.forward_delay || !settings.backward_delay) return ", delays unknown";
  const auto milliseconds = [](double seconds) { return readable(1e3 * seconds); };
  if (*settings.forward_delay + *settings.backward_delay == 0.0) return ", without delay";
  return ", with " + milliseconds(*settings.forward_delay) + " + " +
         milliseconds(*settings.backward_delay) + " ms";
}

std::string with_delays(const std::string& errors, const RunFindings& run) {
  return errors == kNoValue ? errors : errors + delay_text(run.files.settings);
}

std::string format_errors(const std::vector<double>& errors, double scale, const char* unit) {
  if (errors.empty()) return kNoValue;
  const ErrorStatistics stats = statistics(errors);
  return "median " + with_unit(scale * stats.median, unit) + ", rmse " +
         with_unit(scale * stats.rmse, unit) + ", p95 " + with_unit(scale * stats.p95, unit) +
         ", max " + with_unit(scale * stats.max, unit);
}

/// A parameter of every object that has it, each formatted by `text`.
template <typename Text>
std::string format_parameter(const Findings& findings, const std::string& name, Text text) {
  std::string all;
  for (const ParameterError& error : findings.parameters) {
    const std::string one = error.name == name ? text(error) : std::string();
    if (!one.empty()) all += (all.empty() ? "" : "; ") + error.object + " " + one;
  }
  return all.empty() ? kNoValue : all;
}

/// STD of F_M from push to push, as paper C's; where it is unknown, the value's own.
std::optional<double> limit_scatter(const Findings& findings, const ParameterError& limit) {
  if (const auto& known = findings.run->files.parameters) {
    const auto& scatter = known->at(limit.object).limiting_static_friction_scatter;
    if (scatter) return scatter->value;
  }
  return limit.estimate->std;
}

/// Only boxes with about the paper's limiting friction can be compared with it.
std::string limiting_friction_near(const Findings& findings, double paper) {
  constexpr double kTolerance = 0.02;  // relative: the paper's std is 6 to 9 %
  return format_parameter(findings, "limiting_static_friction", [&](const ParameterError& error) {
    const double known = error.truth ? *error.truth : paper;
    if (!error.estimate || std::abs(known - paper) > kTolerance * paper) return std::string();
    const std::optional<double> scatter = limit_scatter(findings, error);
    return with_unit(error.estimate->value, "N") +
           (scatter ? ", " + with_unit(*scatter, "N") : "") +
           (error.truth ? " (true: " + with_unit(*error.truth, "N") + ")" : "");
  });
}

std::string mass_errors(const Findings& findings) {
  return format_parameter(findings, "mass", [](const ParameterError& error) {
    if (error.is_given) return std::string("given");
    return error.relative ? with_unit(kPercent * *error.relative, "%") : std::string();
  });
}

/// Values by object: "stiffness 2.1e+04 N/m^n, damping ..., exponent 1.5", each where it is known.
std::string values_of(const Findings& findings, const std::vector<std::string>& names) {
  std::map<std::string, std::string> by_object;
  for (const ParameterError& error : findings.parameters) {
    const auto name = std::find(names.begin(), names.end(), error.name);
    if (name == names.end() || !error.estimate) continue;
    std::string& text = by_object[error.object];
    std::string label = error.name.substr(error.name.find('.') + 1);  // contact.stiffness
    std::replace(label.begin(), label.end(), '_', ' ');
    text += (text.empty() ? " " : ", ") + label + ' ' + readable(error.estimate->value);
    if (!error.unit.empty()) text += ' ' + error.unit;
  }
  std::string all;
  for (const auto& [object, text] : by_object) all += (all.empty() ? "" : "; ") + object + text;
  return all.empty() ? kNoValue : all;
}

std::vector<ContactPeak> peaks_of(const RunFindings& run, ContactTask task) {
  std::vector<ContactPeak> chosen;
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      if (peak.task == task) chosen.push_back(peak);
    }
  }
  return chosen;
}

std::string max_forces(const std::vector<ContactPeak>& peaks) {
  const ContactPeak& max_peak = *std::max_element(
      peaks.begin(), peaks.end(),
      [](const ContactPeak& a, const ContactPeak& b) { return a.measured < b.measured; });
  return with_unit(max_peak.measured, "N") + ", " + with_unit(max_peak.rendered, "N") + ", " +
         with_unit(kPercent * std::abs(max_peak.rendered - max_peak.measured) / max_peak.measured,
                   "%");
}

std::string peak_error_text(const std::vector<ContactPeak>& presses) {
  std::vector<double> errors;
  for (const ContactPeak& peak : presses) {
    errors.push_back(std::abs(peak.rendered - peak.measured) / peak.measured);
  }
  return press_errors_text(errors);
}

}  // namespace

ReportTable paper_table(const Findings& findings) {
  const RunFindings& run = *findings.run;
  ReportTable table{.title = "Published results and this run",
                    .columns = {"metric", "paper", "published", "this run"}};
  const auto add = [&](const Published& published, const std::string& ours) {
    table.rows.push_back({published.what, published.source, published.value, ours});
  };
  const auto millimetres = [](const std::vector<PoseError>& errors) {
    return format_errors(translations(errors), kMillimetres, "mm");
  };
  add(kLimitingFoam, limiting_friction_near(findings, 9.57));
  add(kLimitingRubber, limiting_friction_near(findings, 40.62));
  add(kContactLaw,
      values_of(findings, {"contact.stiffness", "contact.damping", "contact.exponent"}));
  add(kFriction, values_of(findings, {"sliding_friction_coefficient", "viscous_friction"}));
  add(kMass, mass_errors(findings));
  add(kSlidingError,
      with_delays(millimetres(predicted_errors_in(
                      findings, [](Phase phase) { return phase == Phase::sliding; })),
                  run));
  add(kSystemError,
      with_delays(millimetres(predicted_errors_in(findings, is_touched_or_moving)), run));
  add(kForceError,
      with_delays(format_errors(relative_force_errors(run.forces_with_parameters), kPercent, "%"),
                  run));
  const std::vector<ContactPeak> presses = experiment_presses(run, false);
  const std::vector<ContactPeak> soft = experiment_presses(run, true);
  if (!presses.empty()) add(kPeakError, peak_error_text(presses));
  if (!soft.empty()) add(kSoftError, peak_error_text(soft));
  const std::vector<ContactPeak> slotting = peaks_of(run, ContactTask::slotting);
  if (!slotting.empty()) add(kSlotting, max_forces(slotting));
  add_arm_rows(run, table);
  table.note =
      "B: haptic augmented reality with seven damping laws; C: movable objects in a point-cloud "
      "augmented virtual environment. The papers use real boxes and robots; for a run of a "
      "simulated recording, this compares methods under the given noise, not hardware. Not in the "
      "source: the available text of C lacks its tables' numbers. –: this run has no value. B's "
      "presses, soft object and slotting are listed for runs of such contacts. C's figure 8, the "
      "comparison of estimators, is in the report of pcavr identify.";
  return table;
}

ReportTable contact_table(const Findings& findings) {
  const RunFindings& run = *findings.run;
  ReportTable table{
      .title = "Peak force of each contact",
      .columns = {"contact", "task", "speed (mm/s)", "measured (N)", "rendered (N)", "error (%)"},
      .is_folded = true};
  const auto add = [&](const std::string& name, ContactTask task, const std::string& speed,
                       double measured, double rendered) {
    table.rows.push_back({name, std::string(to_string(task)), speed, readable(measured),
                          readable(rendered),
                          readable(kPercent * std::abs(rendered - measured) / measured)});
  };
  for (const auto& [object, peaks] : run.peaks) {
    for (const ContactPeak& peak : peaks) {
      const std::string t = fixed(to_seconds(peak.begin - findings.origin), 3);
      const std::optional<double>& speed = peak.approach_speed;
      add(object + ", from " + t + " s", peak.task,
          speed ? readable(kMillimetres * *speed) : kNoValue, peak.measured, peak.rendered);
    }
  }
  return table;
}

}  // namespace pcavr
